"""Marks functions as cases: case_of(CASES) gives a decorator that notes id, tier and source."""


def case_of(cases):
    def case(name, tier, title, source=""):
        def mark(function):
            function.id, function.tier, function.title, function.source = name, tier, title, source
            cases.append(function)
            return function
        return mark
    return case
