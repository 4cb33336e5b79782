"""Gas or liquid through a bed of bodies: volume-averaged Navier-Stokes equations on a box. Needs dolfinx 0.5 (Debian 12) or 0.9 (Debian 13).

Equations, model A (D. Gidaspow, Multiphase Flow and Fluidization, 1994): the pressure gradient acts on the fluid and on the bodies.
    rho eps (du/dt + u . grad u) = -eps grad p + div(eps mu grad u) - B (u - us),    d eps/dt + div(eps u) = 0
    eps void fraction, u velocity of the fluid, us mean velocity of the bodies, p pressure without its hydrostatic part rho g . x [SI units].
Drag B (Gidaspow): S. Ergun, Chem. Eng. Prog. 48 (1952) 89, for eps < 0.8; C. Y. Wen, Y. H. Yu, Chem. Eng. Prog. Symp. Ser. 62 (1966) 100, above.
    It jumps at 0.8. Ergun's diameter is sphericity times the diameter of the ball of equal volume, that of Wen and Yu is the latter alone.
Boundaries: z low is the inlet (given velocity in +z, free of bodies), z high the outlet (p = 0), the sides are slip walls.
Spaces: hexahedra, u in Q2, p in Q1 (Taylor, Hood); eps, B and B us in Q1 from their values at the vertices of the cells.
Time: backward Euler over one window. The convecting velocity and the slip in B are those of the window before: one linear system a window
    (MUMPS, one rank). Stable while the window is short against the relaxation time m / (K V) of a body; `relaxation_rate` holds the largest K.
Stabilisation: along each axis the viscosity rho |u| h / 2 of upwind differences is added, without which u oscillates at the top of a bed. It changes
    no sum of forces; the pressure drop is of first order in the height of a cell.
Bodies to fluid: each body spreads its volume by hats (triangles along each axis) of half width max(2.5 d, cell), d of equal volume, normalised per
    body, so that the volume is kept at the walls. A node has one diameter, the Sauter mean of its bodies.
Fluid to bodies: with the same weights w, K = B / (1 - eps) and means over the shape function of a node (bar):
    force = V (sum_i w_i K_i (bar u_i - v) - sum_i w_i bar grad p_i - rho g). Its sum is that of the equations above, without gravity, to rounding.
Limits: laminar (no turbulence model), no torque, no lift, no added mass, isothermal and incompressible; drag of all bodies of a node in proportion to
    their volumes; eps is held above 0.3; a body above the box feels only the buoyancy. Cells are wider than a body at the sides of a narrow box.
"""
import numpy as np
import ufl
from dolfinx import fem, mesh
from dolfinx.fem import petsc
from mpi4py import MPI
from petsc4py import PETSc
from scipy.sparse import csr_matrix


def spaces(domain):
    """Velocity and pressure, scalars, vectors. All that differs between the versions of dolfinx."""
    if hasattr(fem, "functionspace"):   # 0.7 and later
        from basix.ufl import element, mixed_element
        u, p = element("Lagrange", domain.basix_cell(), 2, shape=(3,)), element("Lagrange", domain.basix_cell(), 1)
        return tuple(fem.functionspace(domain, e) for e in (mixed_element([u, p]), p, element("Lagrange", domain.basix_cell(), 1, shape=(3,))))
    u, p = ufl.VectorElement("CG", domain.ufl_cell(), 2), ufl.FiniteElement("CG", domain.ufl_cell(), 1)
    return fem.FunctionSpace(domain, ufl.MixedElement(u, p)), fem.FunctionSpace(domain, p), fem.VectorFunctionSpace(domain, ("CG", 1))


def drag(eps, slip, d, density, viscosity, sphericity=1.0):
    """Drag on a unit volume of bodies over the slip velocity, B / (1 - eps) [kg/(m^3 s)]."""
    ds = sphericity * d
    dense = 150 * (1 - eps) * viscosity / (eps * ds**2) + 1.75 * density * slip / ds
    re = np.maximum(eps * density * slip * d / viscosity, 1e-9)
    cd_re = np.where(re < 1000, 24 * (1 + 0.15 * re**0.687), 0.44 * re)
    dilute = 0.75 * cd_re * viscosity / d**2 * eps**-2.65
    return np.where(eps < 0.8, dense, dilute)


class Fluid:
    def __init__(self, low, high, cells, density, viscosity, window, gravity=(0, 0, -9.81), sphericity=1.0):
        self.low, self.high, self.cells = np.array(low, float), np.array(high, float), np.array(cells, int)
        self.cell, self.area = (self.high - self.low) / self.cells, float(np.prod((self.high - self.low)[:2]))
        self.density, self.viscosity, self.gravity, self.sphericity = density, viscosity, np.array(gravity, float), sphericity
        domain = mesh.create_box(MPI.COMM_SELF, [self.low, self.high], self.cells.tolist(), mesh.CellType.hexahedron)
        both, scalars, vectors = spaces(domain)
        self.eps, self.eps_rate, self.B = (fem.Function(scalars) for _ in range(3))
        self.B_us, self.now, self.before = fem.Function(vectors), fem.Function(both), fem.Function(both)
        self.inflow, self.dt = fem.Constant(domain, PETSc.ScalarType(0)), fem.Constant(domain, PETSc.ScalarType(window))
        self.eps.x.array[:], self.started = 1, False

        (u, p), (v, q) = ufl.TrialFunctions(both), ufl.TestFunctions(both)
        u_before, u_now = ufl.split(self.before)[0], ufl.split(self.now)[0]
        upwind = [density * self.cell[k] / 2 * ufl.sqrt(u_now[k] ** 2 + 1e-12) for k in range(3)]
        stress = sum((viscosity + upwind[k]) * ufl.dot(u.dx(k), v.dx(k)) for k in range(3))
        form = (density * self.eps * ufl.dot((u - u_before) / self.dt + ufl.dot(ufl.grad(u), u_now), v) + self.eps * stress
                - p * ufl.div(self.eps * v) + ufl.dot(self.B * u - self.B_us, v) - q * (ufl.div(self.eps * u) + self.eps_rate)) * ufl.dx(metadata={"quadrature_degree": 4})
        self.a, self.b = fem.form(ufl.lhs(form)), fem.form(ufl.rhs(form))
        scalar, vector = ufl.TestFunction(scalars), ufl.TestFunction(vectors)
        self.means = [fem.form(ufl.inner(field, vector) * ufl.dx) for field in (u_now, ufl.grad(ufl.split(self.now)[1]))]
        self.node_volume = fem.assemble_vector(fem.form(scalar * ufl.dx)).array.copy()

        def fixed(space, value, axis, ends):
            nodes = fem.locate_dofs_geometrical((space, space.collapse()[0]), lambda x: np.any([np.isclose(x[axis], end[axis]) for end in ends], axis=0))
            return fem.dirichletbc(value, nodes[0], space)
        zero, ends = fem.Constant(domain, PETSc.ScalarType(0)), (self.low, self.high)
        self.fixed = [fixed(both.sub(0).sub(0), zero, 0, ends), fixed(both.sub(0).sub(1), zero, 1, ends),
                      fixed(both.sub(0).sub(2), self.inflow, 2, ends[:1]), fixed(both.sub(1), zero, 2, ends[1:])]
        self.matrix = petsc.create_matrix(self.a)
        self.right, self.found = petsc.assemble_vector(self.b), self.matrix.createVecRight()
        self.solver = PETSc.KSP().create(MPI.COMM_SELF)
        self.solver.setType("preonly")
        self.solver.getPC().setType("lu")
        self.solver.getPC().setFactorSolverType("mumps")
        self.solver.setOperators(self.matrix)

        p_space, self.p_rows = both.sub(1).collapse()
        self.p_nodes = p_space.tabulate_dof_coordinates()
        self.grid = np.empty(self.cells + 1, int)   # node of i, j, k
        self.grid[tuple(np.rint((scalars.tabulate_dof_coordinates() - self.low) / self.cell).astype(int).T)] = np.arange(len(self.node_volume))
        self.u_mean = np.zeros((len(self.node_volume), 3))

    def weights(self, x, width):
        """Share of each body at each node, bodies x nodes, by hats of a half width; a row is 0 where the hat lies outside of the box."""
        h = np.maximum(width[:, None], self.cell)
        reach = np.ceil(h.max(axis=0, initial=0) / self.cell).astype(int)
        first = np.floor((x - self.low) / self.cell).astype(int) - reach + 1
        index, hats = [], []
        for k in range(3):
            i = first[:, k, None] + np.arange(2 * reach[k])
            hat = np.maximum(0, 1 - abs(self.low[k] + i * self.cell[k] - x[:, k, None]) / h[:, k, None])
            hats.append(np.where((i >= 0) & (i <= self.cells[k]), hat, 0))
            index.append(np.clip(i, 0, self.cells[k]))
        node = self.grid[index[0][:, :, None, None], index[1][:, None, :, None], index[2][:, None, None, :]].reshape(len(x), -1)
        w = (hats[0][:, :, None, None] * hats[1][:, None, :, None] * hats[2][:, None, None, :]).reshape(len(x), -1) * self.node_volume[node]
        w /= np.maximum(w.sum(axis=1, keepdims=True), 1e-300)
        return csr_matrix((w.ravel(), node.ravel(), np.arange(len(x) + 1) * w.shape[1]), shape=(len(x), len(self.node_volume)))

    def advance(self, eps, d, us):
        """The flow after one window, through bodies given at the nodes: void fraction, diameter, velocity."""
        self.eps_rate.x.array[:] = (eps - self.eps.x.array) / self.dt.value if self.started else 0
        self.eps.x.array[:], self.started = eps, True
        self.K = drag(eps, np.linalg.norm(self.u_mean - us, axis=1), d, self.density, self.viscosity, self.sphericity)
        self.B.x.array[:] = self.K * (1 - eps)
        self.B_us.x.array[:] = (self.B.x.array[:, None] * us).ravel()
        self.matrix.zeroEntries()
        petsc.assemble_matrix(self.matrix, self.a, bcs=self.fixed)
        self.matrix.assemble()
        self.right.set(0)
        petsc.assemble_vector(self.right, self.b)
        petsc.apply_lifting(self.right, [self.a], [self.fixed])
        petsc.set_bc(self.right, self.fixed)
        self.solver.solve(self.right, self.found)
        if self.solver.getConvergedReason() < 0 or not np.isfinite(self.found.array).all():
            raise FloatingPointError("the linear system of the flow has no solution")
        self.now.x.array[:] = self.before.x.array[:] = self.found.array
        self.u_mean, self.grad_p = (fem.assemble_vector(form).array.reshape(-1, 3) / self.node_volume[:, None] for form in self.means)

    def exchange(self, position, velocity, volume):
        """One window: void fraction and drag from the bodies, then the flow. Returns the force of the fluid on each body, n x 3 [N]."""
        d = np.cbrt(6 / np.pi * volume)
        w = self.weights(position, 2.5 * d)
        solid = w.T @ volume
        held = np.maximum(solid, 1e-300)
        eps = np.clip(1 - solid / self.node_volume, 0.3, 1)
        self.d = np.where(solid > 0, solid / np.maximum(w.T @ (volume / d), 1e-300), d.mean())
        self.advance(eps, self.d, (w.T @ (volume[:, None] * velocity)) / held[:, None])
        share = (1 - eps) * self.node_volume / held   # 1, or less where eps was raised to its limit: keeps the sum of the forces
        K = self.K * share
        self.relaxation_rate = (w @ K).max()
        return volume[:, None] * (w @ (K[:, None] * self.u_mean - share[:, None] * self.grad_p) - (w @ K)[:, None] * velocity - self.density * self.gravity)

    def pressure_drop(self):
        """Mean over the inlet less the mean over the outlet, without the hydrostatic part [Pa]."""
        p, z = self.now.x.array[self.p_rows], self.p_nodes[:, 2]
        return p[np.isclose(z, self.low[2])].mean() - p[np.isclose(z, self.high[2])].mean()

    def expected_drop(self, velocity):
        """Pressure drop [Pa] of a uniform flow through the deposited void fraction: Ergun (Wen and Yu above 0.8), integrated over the height."""
        level = np.arange(self.cells[2] + 1) * self.cell[2]
        z = (np.arange(4000) + 0.5) / 4000 * level[-1]
        volume = self.node_volume[self.grid]
        eps, d = (np.interp(z, level, (field[self.grid] * volume).sum(axis=(0, 1)) / volume.sum(axis=(0, 1))) for field in (self.eps.x.array, self.d))
        return (drag(eps, velocity / eps, d, self.density, self.viscosity, self.sphericity) * (1 - eps) * velocity / eps**2).mean() * level[-1]
