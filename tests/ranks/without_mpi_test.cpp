// A program of claray without claray-mpi.so, as where Open MPI is not installed.
#include <gtest/gtest.h>

#include "host/ranks/session.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

/// The program opens a session only where a launcher started several processes.
TEST(WithoutMpi, SaysSoUnderALauncher) {
    for (const char* variable : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE"}) ::unsetenv(variable);
    EXPECT_FALSE(ranks::started_together());
    ::setenv("OMPI_COMM_WORLD_SIZE", "2", 1), ::setenv("OMPI_COMM_WORLD_RANK", "1", 1);
    EXPECT_TRUE(ranks::started_together());
    EXPECT_EQ(ranks::rank_by_launcher(), 1);
    ::unsetenv("OMPI_COMM_WORLD_SIZE"), ::unsetenv("OMPI_COMM_WORLD_RANK");

    const TemporaryFolder folder;
    const fs::path alone = folder / "claray";
    fs::copy_file(CLARAY_PROGRAM, alone);
    const ProcessResult result = run_process(
        {"env", "OMPI_COMM_WORLD_SIZE=2", "OMPI_COMM_WORLD_RANK=0", alone.string(), "render", "cornell", "-q"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_NE(result.errors.find("MPI cannot be used: claray-mpi.so"), std::string::npos) << result.errors;
    EXPECT_NE(result.errors.find("install Open MPI"), std::string::npos) << result.errors;
}

}  // namespace
}  // namespace claray::test
