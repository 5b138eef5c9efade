#include "host/base/process/plugin.hpp"
#include "host/ranks/mpi/mpi.hpp"

namespace claray::ranks {

Mpi& load_mpi() {
    return *plugin_function<Mpi*()>(
        "claray-mpi.so", "claray_mpi",
        "MPI cannot be used: ", "install Open MPI and a claray that was built with it, or start it without mpirun")();
}

}  // namespace claray::ranks
