"""Requirements of docs/reference/validation-plan.md that are missed today, each with the physics or the limit behind it.

A miss stays a miss in every table. This list only distinguishes known misses from new ones: validate.py fails when a requirement
is missed that is not here, and also when one that is here holds again, so that the list cannot outlive its reasons.
The key is (case, start of the printed line).
"""

KNOWN = {
    ("C3", "icosphere L4, rubber: largest force"):
        "2.2 % where 2 % is demanded (33 % with unit weights): the facets of a mesh of level 4 under an impact sixty facets deep. Level 5 has 0.6 %. Overlap "
        "(0.2 %) and duration (1.3 %) agree. Use the analytic sphere for soft spheres.",
    ("F6", "512-gon, 20 degrees: a by its own inertia"):
        "0.502 % where 0.5 % is demanded. A rolling prism creeps by the stretch that the friction spring of each new vertex needs, in proportion to the overlap. "
        "With weights by density a line of vertices is as stiff as one contact and not stiffer by their number, so that the overlap is larger. Unit weights have 0.49 %.",
    ("F3", "velocity reversal over v0"):
        "A block that stops keeps the stretch of its friction springs, mu m g, and springs back with v = mu g sqrt(m/k_t): 9e-4 v0 "
        "at k = 1e6 N/m. This speed falls with 1/sqrt(k): 1e-6 would require k = 1e12 N/m. Any elastic-plastic friction law behaves like this.",
    ("B3", "tetrahedron: solid fraction"):
        "0.67 where 0.763 is demanded, which is the densest random packing, compressed or shaken for long. Ours are poured and left alone; it is not the size of the bed: 600 tetrahedra "
        "between sides seven wide have 0.661 +- 0.015. The other three kinds come within 0.04 of theirs.",
    ("B4", "R^2 of the exponential"):
        "0.96 where 0.98 is demanded, five packings of each height: what the bottom carries still grows, by a quarter, from 2 to 3.5 diameters of fill, where one constant K says 10 %. Single packings of "
        "a silo six grains across scatter by 10 to 20 %. The silo of real size (15 across) was not run to its end.",
    ("B1", "frictionless: neighbours without rattlers"):
        "Six is the limit of hard spheres. Analytic spheres in the same bed have 6.29, since the contacts are soft (half of the margins is used). "
        "Facets add 0.2: a body that is not quite round is subject to torques and needs more neighbours for equilibrium.",
}


def reason(case, what):
    for (name, start), why in KNOWN.items():
        if name == case and what.startswith(start):
            return why
    return ""
