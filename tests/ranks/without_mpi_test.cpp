// A claray that was built without MPI: the session as it is compiled then, under another name.
#include <gtest/gtest.h>

#include "claray/error.hpp"
#include "tests/support/errors.hpp"

#undef CLARAY_WITH_MPI
#define CLARAY_WITH_MPI 0
#define ranks ranks_without_mpi
#include "host/ranks/session.cpp"  // NOLINT(bugprone-suspicious-include)
#undef ranks

namespace claray::test {
namespace {

/// The program opens a session only where a launcher started several processes.
TEST(WithoutMpi, SaysSoUnderALauncher) {
    for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) ::unsetenv(variable);
    EXPECT_FALSE(ranks_without_mpi::started_together());
    ::setenv("OMPI_COMM_WORLD_SIZE", "2", 1), ::setenv("OMPI_COMM_WORLD_RANK", "1", 1);
    EXPECT_TRUE(ranks_without_mpi::started_together());
    EXPECT_EQ(ranks_without_mpi::rank_by_launcher(), 1);
    ::unsetenv("OMPI_COMM_WORLD_SIZE"), ::unsetenv("OMPI_COMM_WORLD_RANK");
    EXPECT_TRUE(throws_error(ErrorKind::user, "this claray was built without MPI; install libopenmpi-dev",
                             [] { const ranks_without_mpi::Session session; }));
}

}  // namespace
}  // namespace claray::test
