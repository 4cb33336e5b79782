"""The environment of tests that start Open MPI: works as root in a container and with more ranks than cores, binds no rank to a core, and lets a
rank that waits give its core away, since tests share the machine. Open MPI 4 (Debian 12) reads the names with OMPI_, Open MPI 5 (Debian 13) starts
ranks by PRRTE, whose names begin with PRTE_; each ignores the names of the other."""
import os

MPI_VARIABLES = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "PRTE_ALLOW_RUN_AS_ROOT": "1", "PRTE_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1", "OMPI_MCA_hwloc_base_binding_policy": "none",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe", "PRTE_MCA_hwloc_default_binding_policy": "none",
    "OMPI_MCA_mpi_yield_when_idle": "1",
}


def grace_before_kill(seconds):
    """Variables: how long mpirun waits for the ranks of a run that has failed before it kills them."""
    return {name: str(seconds) for name in ("OMPI_MCA_odls_base_sigkill_timeout", "PRTE_MCA_odls_base_sigkill_timeout")}


def mpi_environment(**more):
    """This process's environment with these variables and `more`."""
    return dict(os.environ, **MPI_VARIABLES, **more)
