#include "host/compute/tuning.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "claray/device.hpp"

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
    Tuning tuning;
    apply_tuning(table, "table", info, tuning);
    return tuning.values.at("sort/scan GROUP");
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
    std::ofstream(folder / "claray/tuning.txt") << "* bvh/hploc GROUP_SIZE 32\n* sort/radix_sort ITEMS 2\n";
    std::ofstream(folder / "named.txt") << "* sort/radix_sort ITEMS 3\n";
    EXPECT_EQ(tuning_for(device().info()).values.at("sort/radix_sort ITEMS"), 2u);
    const ScopedEnvironment named("CLARAY_TUNING", (folder / "named.txt").string());
    EXPECT_EQ(tuning_for(device().info()).values.at("bvh/hploc GROUP_SIZE"), 32u);
    EXPECT_EQ(tuning_for(device().info()).values.at("sort/radix_sort ITEMS"), 3u);
    EXPECT_TRUE(tuning_for(device().info()).warnings.empty());
}

TEST(Tuning, MalformedRowsNameTableAndLine) {
    for (const char* row : {"*", "* kernel", "* kernel P", "* kernel P many", "* kernel P -1", "* kernel P 4294967296",
                            "* kernel P 1 2", "* kernel P 1.5", "* kernel P -", "* kernel P 1 2..1", "* kernel P 1 ..",
                            "* kernel P 1 0..1x3", "* kernel P 1 0..1 2"}) {
        Tuning tuning;
        const std::string table = std::string("\n") + row;
        for (const auto apply : {apply_tuning, apply_users_tuning})
            EXPECT_TRUE(throws_error(ErrorKind::user, "table:2: not a tuning row", [&] {
                apply(table, "table", device().info(), tuning);
            })) << row;
    }
}

class UsersTuning : public testing::Test {
protected:
    UsersTuning() {
        apply_tuning(
            "* a/b C 5 2..9\n* a/b POWER 8 4..64x2\n* a/b ONE 1 1..1\n* a/b INTERNAL 7\ngpu a/b OF_GPUS 1 0..1\n",
            "own", info_, tuning_);
    }
    void apply(const std::string& table) { apply_users_tuning(table, "mine", info_, tuning_); }
    DeviceInfo info_ = device_named("Xeon", DeviceType::cpu);
    Tuning tuning_;
};

TEST_F(UsersTuning, ValuesWithinTheirRangesAreTaken) {
    apply("cpu a/b C 2\n* a/b C 9\n* a/b POWER 32\n");
    EXPECT_EQ(tuning_.values.at("a/b C"), 9u);
    EXPECT_EQ(tuning_.values.at("a/b POWER"), 32u);
    EXPECT_TRUE(tuning_.warnings.empty());
}

TEST_F(UsersTuning, OthersAreIgnoredWithAWarning) {
    const auto before = tuning_.values;
    const std::pair<const char*, const char*> rows[] = {
        {"* a/b C 1", "mine:1: ignored: 'a/b C' cannot be 1; choose a value in 2..9"},
        {"* a/b C 10", "mine:1: ignored: 'a/b C' cannot be 10; choose a value in 2..9"},
        {"* a/b POWER 33", "mine:1: ignored: 'a/b POWER' cannot be 33; choose a power of two in 4..64"},
        {"* a/b ONE 2", "mine:1: ignored: 'a/b ONE' cannot be 2; only 1 works"},
        {"* a/b INTERNAL 7",
         "mine:1: ignored: 'a/b INTERNAL' is not a tuning parameter of this device; remove the line"},
        {"* a/b OF_GPUS 1", "'a/b OF_GPUS' is not a tuning parameter of this device"},
        {"\n* a/b CLARAY_TEXTBOOK 1", "mine:2: ignored: 'a/b CLARAY_TEXTBOOK' is not a tuning parameter"}};
    for (const auto& [row, words] : rows) {
        tuning_.warnings.clear();
        apply(row);
        ASSERT_EQ(tuning_.warnings.size(), 1u) << row;
        EXPECT_NE(tuning_.warnings[0].find(words), std::string::npos) << tuning_.warnings[0];
    }
    EXPECT_EQ(tuning_.values, before);
    tuning_.warnings.clear();
    apply("gpu a/b NONSENSE 1\nH200 a/b C 1\n");
    EXPECT_TRUE(tuning_.warnings.empty()) << "rows of other devices are none of this one's business";
}

TEST_F(UsersTuning, WarningsAreFew) {
    std::string table;
    for (int i = 0; i < 1000; ++i) table += "* a/b NONE 1\n";
    apply(table);
    ASSERT_EQ(tuning_.warnings.size(), 11u);
    EXPECT_NE(tuning_.warnings.back().find("990 more rows are ignored"), std::string::npos);
}

/// What made every ray leak without a word.
TEST(Tuning, NoTableDefinesOtherMacros) {
    const TemporaryFolder folder;
    std::ofstream(folder / "local.txt") << "* trace/closest_hit CLARAY_TEXTBOOK_TRIANGLES 1\n* my/kernel UNROLL 3\n";
    const ScopedEnvironment local("CLARAY_TUNING", (folder / "local.txt").string());
    const Device opened = Device::open(std::to_string(device().info().index));
    EXPECT_EQ(tuning_warnings(opened).size(), 2u);
    for (const auto& [name, value] : with_tuning(opened, "trace/closest_hit", {}))
        EXPECT_NE(name, "CLARAY_TEXTBOOK_TRIANGLES");
}

/// Of the table's values only those that a kernel's text names are compiled into it.
TEST(Tuning, ValuesThatTheHostReadsCompileNothing) {
    const Device fresh = Device::open(std::to_string(device().info().index));
    const auto programs = [&] {
        const CompileStatistics before = compile_statistics();
        (void)load_kernel(fresh, "sort/radix_sort.cl", "count_all_digits");
        const CompileStatistics after = compile_statistics();
        return after.compiled + after.from_cache - before.compiled - before.from_cache;
    };
    EXPECT_EQ(programs(), 1u);
    fresh.set_tuning("sort/radix_sort", "ONESWEEP", 1 - fresh.tuning("sort/radix_sort", "ONESWEEP"));
    EXPECT_EQ(programs(), 0u);
    fresh.set_tuning("sort/radix_sort", "ITEMS", fresh.tuning("sort/radix_sort", "ITEMS") - 1);
    EXPECT_EQ(programs(), 1u);
}

TEST(Tuning, MissingLocalTableIsAnError) {
    const ScopedEnvironment local("CLARAY_TUNING", "/no/such/table.txt");
    EXPECT_TRUE(throws_error(ErrorKind::user,
                             "cannot read '/no/such/table.txt': No such file or directory; set CLARAY_TUNING",
                             [] { (void)tuning_for(device().info()); }));
}

TEST(Tuning, UnknownRowIsAnError) {
    EXPECT_TRUE(throws_error(ErrorKind::usage, "no row 'sort/radix_sort NO_SUCH'",
                             [] { (void)device().tuning("sort/radix_sort", "NO_SUCH"); }));
}

}  // namespace
}  // namespace claray::test
