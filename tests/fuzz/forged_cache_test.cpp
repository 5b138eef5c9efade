// Files of the program cache that were forged: what is in them is given out only where it is of the program asked for.
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>

#include "host/base/hash.hpp"
#include "host/compute/programs/program_cache.hpp"
#include "tests/fuzz/forge.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t sum_at = 8, header_bytes = 32;  // docs/formats.md

/// The checksum stands before what it is of. `key`: of the folder; empty: that of another.
void mend_program(FileBytes& file, const std::string& key) {
    if (file.size() < header_bytes) return;
    const std::string all = key + std::string(file.begin() + sum_at + sizeof(Digest), file.end());
    const Digest sum = digest_of(all.data(), all.size());
    std::memcpy(&file[sum_at], sum.data(), sizeof sum);
}

class ForgedPrograms : public testing::Test {
protected:
    [[nodiscard]] fs::path path_of(const std::string& identity) const { return folder_ / (hash128(identity) + ".bin"); }
    [[nodiscard]] FileBytes stored(const std::string& identity, std::size_t bytes) const {
        EXPECT_EQ(store_cached_program(identity, std::vector<unsigned char>(bytes, 'b')), "");
        const std::string text = read_file(path_of(identity));
        return {text.begin(), text.end()};
    }
    TemporaryFolder folder_;
    ScopedEnvironment cache_dir_{"CLARAY_CACHE_DIR", folder_.path().string()};
};

TEST_F(ForgedPrograms, AreOfTheProgramAskedForOrPassedBy) {
    const std::string identity = "driver 1\n-DVALUE=1\nsome.cl\n", other = "driver 1\n-DVALUE=2\nsome.cl\n";
    const std::size_t begin = header_bytes + identity.size();
    const std::vector<FileBytes> good = {stored(identity, 300), stored(other, 200)};
    const auto is_read = [&](std::span<const std::uint8_t> file) {
        std::ofstream(path_of(identity), std::ios::binary)
            .write(reinterpret_cast<const char*>(file.data()), std::streamsize(file.size()));
        const auto binary = load_cached_program(identity);
        if (!binary) return false;
        EXPECT_EQ(std::string(file.begin() + header_bytes, file.begin() + std::ptrdiff_t(begin)), identity);
        EXPECT_EQ(binary->size(), file.size() - begin);
        return true;
    };
    EXPECT_TRUE(is_read(good[0]));
    EXPECT_FALSE(is_read(good[1])) << "another program's, under this one's name";
    const std::string key = read_file(folder_ / "programs.key");
    const auto mended = [&](FileBytes& file) { mend_program(file, key); };
    const ForgedOutcome outcome = try_forged(good, forged_count(300), begin, mended, is_read);
    std::printf("%u read, %u passed by, memory grew by %.1f MB\n", outcome.read, outcome.refused,
                double(outcome.grown_bytes) * 1e-6);
    EXPECT_GT(outcome.read, 0u) << "what changes the binary alone is read";
    EXPECT_GT(outcome.refused, outcome.read);
    EXPECT_LT(outcome.grown_bytes, 4u << 20);
    const auto without_key = [](FileBytes& file) { mend_program(file, ""); };
    EXPECT_EQ(try_forged(good, forged_count(300), begin, without_key, is_read).read, 0u)
        << "drivers crash on binaries that others change";
}

}  // namespace
}  // namespace claray::test
