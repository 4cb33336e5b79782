"""Temperature of the gas of fluid.py, and the heat that it exchanges with the bodies. Needs dolfinx, as fluid.py.

Equation, on the flow of fluid.py: rho c eps (dT/dt + u . grad T) = div(eps k grad T) - sum_i G_i (T - T_i) w_i    [SI units, K]
    T gas, T_i body i, G_i = h_i A_i its conductance, w_i its weight function (the hats of fluid.py, of integral 1).
Heat transfer: D. J. Gunn, Int. J. Heat Mass Transfer 21 (1978) 467, for eps 0.35 to 1 and Re up to 1e5:
    Nu = h d / k = (7 - 10 eps + 5 eps^2)(1 + 0.7 Re^0.2 Pr^(1/3)) + (1.33 - 2.4 eps + 1.2 eps^2) Re^0.7 Pr^(1/3),  Re = rho eps |u - v| d / mu,
    d of the ball of equal volume, A = pi d^2 / sphericity.
Boundaries: at the inlet the flow carries heat in at the temperature `inlet` (P. V. Danckwerts, Chem. Eng. Sci. 2 (1953) 1); conduction crosses no boundary.
Space: Q1, the space in which the flow keeps its mass, so that the sum of the equations is the balance of heat. Along each axis the diffusivity |u| h / 2 of
    upwind differences is added, as in fluid.py: profiles are of first order in the height of a cell, sums of heat are not affected.
Outflow: that which keeps the mass of the outlet's nodes, for which the flow has its pressure instead of a balance (T. J. R. Hughes, G. Engel, L. Mazzei, M. G.
    Larson, J. Comput. Phys. 163 (2000) 467): the velocity there alone misses up to 2e-3 of the heat where bodies reach up to the outlet.
Exchange: the conductance of a body is at the nodes of its weights: K_j = sum_i w_ij G_i and power K_j T_j - sum_i w_ij G_i T_i leave node j. A body
    exchanges with the mean temperature sum_j w_ij T_j of its nodes. Both sums are the same number, to rounding.
Time: backward Euler over one window with the T_i of its beginning, implicit in T: stable where the gas follows the bodies faster than a window. The bodies
    then warm up within the window, and take a little less: what they did take is given to settle(), and the difference leaves the gas in the next window.
Limits: density, viscosity and flow do not depend on T; no radiation; no heat of friction of the flow; one temperature a body.
"""
import numpy as np
import ufl
from dolfinx import fem
from dolfinx.fem import petsc
from scipy.sparse import csr_matrix, diags
from scipy.sparse.linalg import splu


def gunn(eps, re, pr):
    """Nusselt number of bodies in a bed."""
    return (7 - 10 * eps + 5 * eps**2) * (1 + 0.7 * re**0.2 * pr ** (1 / 3)) + (1.33 - 2.4 * eps + 1.2 * eps**2) * re**0.7 * pr ** (1 / 3)


class GasHeat:
    def __init__(self, flow, heat_capacity, conductivity, temperature, nusselt=gunn):
        """flow: a Fluid; temperature: of the gas at the start and at the inlet, from which its heat is counted [K]; nusselt: function of eps, Re, Pr."""
        self.flow, self.conductivity, self.reference, self.nusselt = flow, conductivity, temperature, nusselt
        self.prandtl = heat_capacity * flow.viscosity / conductivity
        scalars = flow.eps.function_space
        domain = scalars.mesh
        self.T, self.before, self.eps_before = (fem.Function(scalars) for _ in range(3))
        self.T.x.array[:], self.started = temperature, False
        self.inlet = fem.Constant(domain, type(flow.dt.value.item())(temperature))
        self.held = self.inflow = self.outflow = self.to_bodies = 0.0   # [J] since the start: in the gas, carried in and out, taken by bodies
        self.owed = np.zeros(len(flow.node_volume))   # at the nodes: taken by bodies in the last window, and not from the gas yet [J]

        volume, T, s = flow.density * heat_capacity, ufl.TrialFunction(scalars), ufl.TestFunction(scalars)
        u, n, rule = ufl.split(flow.now)[0], ufl.FacetNormal(domain), {"quadrature_degree": 4}   # as the flow keeps its mass
        into = volume * flow.eps * (abs(ufl.dot(u, n)) - ufl.dot(u, n)) / 2
        spread = [conductivity + volume * flow.cell[k] / 2 * ufl.sqrt(u[k] ** 2 + 1e-12) for k in range(3)]
        form = ((volume * (self.eps_before * (T - self.before) / flow.dt + flow.eps * ufl.dot(u, ufl.grad(T))) * s
                 + flow.eps * sum(spread[k] * T.dx(k) * s.dx(k) for k in range(3))) * ufl.dx(metadata=rule) + into * (T - self.inlet) * s * ufl.ds(metadata=rule))
        self.a, self.b = fem.form(ufl.lhs(form)), fem.form(ufl.rhs(form))
        above, kept = self.T - temperature, flow.eps_rate + ufl.div(flow.eps * u)   # 0 for the functions of all nodes but those of the outlet, where p is given
        self.sums = [fem.form(flux) for flux in (
            volume * flow.eps * above * ufl.dx(metadata=rule), into * (self.inlet - temperature) * ufl.ds(metadata=rule),
            (volume * flow.eps * ufl.dot(u, n) + into) * above * ufl.ds(metadata=rule) - volume * kept * above * ufl.dx(metadata=rule))]

    def conductances(self, w, d, velocity, sphericity):
        """G of each body [W/K], at the present flow."""
        eps, u = w @ self.flow.eps.x.array, w @ self.flow.u_mean
        re = self.flow.density * eps * np.linalg.norm(u - velocity, axis=1) * d / self.flow.viscosity
        inside = np.diff(w.indptr) > 0
        inside &= np.asarray(w.sum(axis=1)).ravel() > 0.5   # a body above the box of the fluid exchanges nothing
        return np.where(inside, self.nusselt(eps, re, self.prandtl) * self.conductivity * np.pi * d / sphericity, 0)

    def exchange(self, position, velocity, volume, temperature, sphericity=1.0):
        """One window, after that of the flow: the gas, with bodies of these temperatures. Returns the conductance of each body [W/K], and the temperature
        of the gas around it [K]. in: n x 3, n x 3, n, n."""
        d = np.cbrt(6 / np.pi * volume)
        self.w = self.flow.weights(position, 2.5 * d)
        G = self.conductances(self.w, d, velocity, sphericity)
        around = self.advance(G, temperature)
        return G, np.where(G > 0, around, self.inlet.value)

    def advance(self, G, temperature):
        """The gas after one window; the temperature of it around each body [K]."""
        flow, dt = self.flow, float(self.flow.dt.value)
        self.before.x.array[:] = self.T.x.array
        if not self.started:
            self.eps_before.x.array[:], self.started = flow.eps.x.array, True
        matrix = petsc.assemble_matrix(self.a)
        matrix.assemble()
        rows, columns, values = matrix.getValuesCSR()
        matrix.destroy()
        right = fem.assemble_vector(self.b).array + self.w.T @ (G * temperature) - self.owed / dt
        system = csr_matrix((values, columns, rows)) + diags(self.w.T @ G)
        self.T.x.array[:] = splu(system.tocsc()).solve(right)
        if not np.isfinite(self.T.x.array).all():
            raise FloatingPointError("the linear system of the gas temperature has no solution")
        self.eps_before.x.array[:] = flow.eps.x.array
        around = self.w @ self.T.x.array
        self.expected = dt * G * (around - temperature)   # by each body [J]
        self.held, into, out = (fem.assemble_scalar(form) for form in self.sums)
        self.inflow += dt * into
        self.outflow += dt * out
        self.to_bodies += self.expected.sum() + self.owed.sum()
        self.owed[:] = 0
        return around

    def settle(self, heat):
        """Of each body of the last exchange(): the heat that it did take in the window [J]."""
        self.owed = self.w.T @ (heat - self.expected)

    def imbalance(self):
        """Of the gas alone, since the start: what came in less what went out, was taken and is held [J]."""
        return self.inflow - self.outflow - self.to_bodies - self.held
