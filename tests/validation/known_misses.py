"""Demands of docs/reference/validation-plan.md that are missed today, each with the physics or the limit behind it.

A miss stays a miss in every table. This list only tells an old miss from a new one: validate.py fails when a demand is
missed that is not here, and also when one that is here holds again, so that the list cannot outlive its reasons.
The key is (case, start of the line that is printed).
"""

KNOWN = {
    ("C3", "icosphere L4, rubber"):
        "The potential counts every corner that carries: an impact that is dozens of facets deep (here 3 mm, facets 0.05 mm high) "
        "has D = (sum d^8)^(1/8) above the largest depth, so the mesh is stiffer than the sphere it stands for. An impact about as deep as a "
        "facet is high agrees to 3e-6. Use the analytic sphere for soft balls.",
    ("F3", "velocity reversal over v0"):
        "A block that stops keeps the stretch of its friction springs, mu m g, and springs back with v = mu g sqrt(m/k_t): 9e-4 v0 "
        "at k = 1e6 N/m. It falls with 1/sqrt(k): 1e-6 would need k = 1e12 N/m. Any elastic-plastic friction law does this.",
    ("B1", "frictionless: neighbours without rattlers"):
        "Six is the limit of hard round balls. Analytic spheres in the same bed have 6.29, since the contacts are soft (half of the margins used), "
        "and facets add 0.2: a body that is not quite round feels torques and takes more neighbours to hold.",
}


def reason(case, what):
    for (name, start), why in KNOWN.items():
        if name == case and what.startswith(start):
            return why
    return ""
