#include "host/compute/tuning.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/device.hpp"
#include "tests/support/errors.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

DeviceInfo device_named(const std::string& name, DeviceType type) {
    DeviceInfo info;
    info.name = name;
    info.type = type;
    return info;
}

unsigned value_for(const std::string& table, const DeviceInfo& info) {
    std::map<std::string, unsigned> values;
    apply_tuning(table, "table", info, values);
    return values.at("sort/scan GROUP");
}

TEST(Tuning, LaterRowsThatMatchWin) {
    const std::string table =
        "# a comment\n"
        "\n"
        "*     sort/scan GROUP 1\n"
        "  cpu sort/scan GROUP 2   # processors\n"
        "gpu\tsort/scan\tGROUP\t3\n"
        "H200  sort/scan GROUP 4294967295\n";
    EXPECT_EQ(value_for(table, device_named("FPGA", DeviceType::other)), 1u);
    EXPECT_EQ(value_for(table, device_named("Xeon", DeviceType::cpu)), 2u);
    EXPECT_EQ(value_for(table, device_named("A100", DeviceType::gpu)), 3u);
    EXPECT_EQ(value_for(table, device_named("NVIDIA H200", DeviceType::gpu)), 4294967295u);
}

TEST(Tuning, PatternsArePartsOfTheNameAndUnderscoresStandForAnything) {
    const DeviceInfo info = device_named("NVIDIA H200 NVL", DeviceType::gpu);
    for (const char* pattern : {"*", "gpu", "H200", "NVIDIA_H200", "NVIDIA_H200_NVL", "H_00"})
        EXPECT_TRUE(pattern_matches(pattern, info)) << pattern;
    for (const char* pattern : {"cpu", "h200", "H100", "NVIDIAH200", "NVIDIA_H200_NVL_", "H200__NVL"})
        EXPECT_FALSE(pattern_matches(pattern, info)) << pattern;
}

TEST(Tuning, UsersTableLiesBetweenTheBuiltInAndTheNamedOne) {
    const TemporaryFolder folder;
    const ScopedEnvironment config("XDG_CONFIG_HOME", folder.path().string());
    EXPECT_EQ(local_tuning_path(), folder / "claray/tuning.txt");
    EXPECT_NO_THROW((void)tuning_for(device().info())) << "it need not exist";
    std::filesystem::create_directory(folder / "claray");
    std::ofstream(folder / "claray/tuning.txt") << "* sort/radix_sort GROUP_SIZE 1\n* sort/radix_sort ITEMS 2\n";
    std::ofstream(folder / "named.txt") << "* sort/radix_sort ITEMS 3\n";
    EXPECT_EQ(tuning_for(device().info()).at("sort/radix_sort ITEMS"), 2u);
    const ScopedEnvironment named("CLARAY_TUNING", (folder / "named.txt").string());
    EXPECT_EQ(tuning_for(device().info()).at("sort/radix_sort GROUP_SIZE"), 1u);
    EXPECT_EQ(tuning_for(device().info()).at("sort/radix_sort ITEMS"), 3u);
}

TEST(Tuning, MalformedRowsNameTableAndLine) {
    for (const char* row : {"*", "* kernel", "* kernel P", "* kernel P many", "* kernel P -1", "* kernel P 4294967296",
                            "* kernel P 1 2", "* kernel P 1.5"}) {
        std::map<std::string, unsigned> values;
        EXPECT_TRUE(throws_error(ErrorKind::user, "table:2: not a tuning row", [&] {
            apply_tuning(std::string("\n") + row, "table", device().info(), values);
        })) << row;
    }
}

TEST(Tuning, LocalTableWinsOverTheBuiltIn) {
    const TemporaryFolder folder;
    std::ofstream(folder / "local.txt") << "* sort/radix_sort GROUP_SIZE 64\n* my/kernel UNROLL 3\n";
    const ScopedEnvironment local("CLARAY_TUNING", (folder / "local.txt").string());
    const auto values = tuning_for(device().info());
    EXPECT_EQ(values.at("sort/radix_sort GROUP_SIZE"), 64u);
    EXPECT_EQ(values.at("my/kernel UNROLL"), 3u);
}

TEST(Tuning, MissingLocalTableIsAnError) {
    const ScopedEnvironment local("CLARAY_TUNING", "/no/such/table.txt");
    EXPECT_TRUE(throws_error(ErrorKind::user,
                             "cannot read '/no/such/table.txt': No such file or directory; CLARAY_TUNING names it",
                             [] { (void)tuning_for(device().info()); }));
}

TEST(Tuning, UnknownRowIsAnError) {
    EXPECT_TRUE(throws_error(ErrorKind::usage, "no row 'sort/radix_sort NO_SUCH'",
                             [] { (void)device().tuning("sort/radix_sort", "NO_SUCH"); }));
}

}  // namespace
}  // namespace claray::test
