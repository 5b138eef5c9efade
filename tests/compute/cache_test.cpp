// Compiled programs on disk.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <thread>

#include "claray/program.hpp"
#include "host/compute/programs/kernel_sources.hpp"
#include "host/compute/programs/program_cache.hpp"
#include "tests/support/device.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* source = "kernel void set(global int* out) { *out = VALUE; }";

class Cache : public testing::Test {
protected:
    /// Compiles on a device opened anew, so that only the disk remembers; checks the result.
    struct Counts {
        unsigned compiled, from_cache;
    };
    Counts compile(int value, Math math = Math::strict) const {
        const CompileStatistics before = compile_statistics();
        const Device fresh = Device::open(std::to_string(device().info().index));
        Buffer<int> out(fresh, 1);
        Kernel kernel = compile_kernel(fresh, source, "set", {{"VALUE", std::to_string(value)}}, math);
        kernel.run({1}, out);
        EXPECT_EQ(out.read()[0], value);
        (void)compile_kernel(fresh, source, "set", {{"VALUE", std::to_string(value)}}, math);  // from memory: no count
        const CompileStatistics after = compile_statistics();
        return {after.compiled - before.compiled, after.from_cache - before.from_cache};
    }
    void expect_compiled(Counts counts) const { EXPECT_TRUE(counts.compiled == 1 && counts.from_cache == 0); }
    void expect_from_cache(Counts counts) const { EXPECT_TRUE(counts.compiled == 0 && counts.from_cache == 1); }
    /// Of programs, and what else should not be there.
    std::vector<fs::path> files() const {
        std::vector<fs::path> files(fs::directory_iterator(folder_.path()), fs::directory_iterator{});
        std::erase_if(files, [](const fs::path& file) {
            return file.extension() == ".lock" || file.filename() == "programs.key" || file.filename() == "drivers.ok";
        });
        return files;
    }

    TemporaryFolder folder_;
    ScopedEnvironment cache_dir_{"CLARAY_CACHE_DIR", folder_.path().string()};
};

TEST_F(Cache, SecondCompilationComesFromDisk) {
    expect_compiled(compile(1));
    expect_from_cache(compile(1));
    ASSERT_EQ(files().size(), 1u);
    EXPECT_EQ(files()[0].extension(), ".bin");
}

TEST_F(Cache, OptionsAreInTheKey) {
    expect_compiled(compile(1));
    expect_compiled(compile(2));
    expect_compiled(compile(1, Math::fast));
    EXPECT_EQ(files().size(), 3u);
    expect_from_cache(compile(1));
    expect_from_cache(compile(2));
    expect_from_cache(compile(1, Math::fast));
}

/// Neither claray's cache nor the driver's own, which tests keep from run to run, takes a program for another one that
/// differs in a header only.
TEST_F(Cache, AChangedHeaderIsCompiledAnew) {
    const std::string path = "math/vector.clh", text = kernel_source(path).text;
    const auto value_with = [&](const std::string& value) {
        replace_kernel_source(path, text + "#define OF_THE_HEADER " + value + "\n");
        const Device fresh = Device::open(std::to_string(device().info().index));
        Buffer<int> out(fresh, 1);
        const char* main = "#include \"math/vector.clh\"\nkernel void set(global int* out) { *out = OF_THE_HEADER; }";
        compile_kernel(fresh, main, "set").run({1, 1}, out);
        return out.read()[0];
    };
    const unsigned compiled = compile_statistics().compiled, from_cache = compile_statistics().from_cache;
    EXPECT_EQ(value_with("1"), 1);
    EXPECT_EQ(value_with("2"), 2);
    EXPECT_EQ(compile_statistics().compiled, compiled + 2);
    EXPECT_EQ(value_with("1"), 1);
    EXPECT_EQ(compile_statistics().from_cache, from_cache + 1);
    replace_kernel_source(path, text);
}

/// The source that the driver knows of a program; a program that was compiled and linked has none.
std::string source_of(const Kernel& kernel) {
    return kernel.handle().getInfo<CL_KERNEL_PROGRAM>().getInfo<CL_PROGRAM_SOURCE>();
}

TEST_F(Cache, OneCallFindsTheHeadersAndLeavesNoFolder) {
    const char* text =
        "#include \"math/vector.clh\"\nkernel void set(global float* out) { *out = dot(out[0], out[1]); }";
    const TemporaryFolder temporary;
    const auto compile_with = [&](unsigned one_call, const fs::path& folder) {
        const ScopedEnvironment environment("TMPDIR", folder.string());
        const Device fresh = Device::open(std::to_string(device().info().index));
        fresh.set_tuning("compute/programs", "ONE_CALL", one_call);
        return compile_kernel(fresh, text, "set");
    };
    EXPECT_NE(source_of(compile_with(1, temporary.path())).find("claray-sources/math/vector.clh"), std::string::npos);
    EXPECT_TRUE(fs::is_empty(temporary.path()));
    fs::remove(files().at(0));
    EXPECT_EQ(source_of(compile_with(1, temporary.path() / "none")), "") << "compiled and linked instead";
    fs::remove(files().at(0));
    EXPECT_EQ(source_of(compile_with(0, temporary.path())), "");
}

void overwrite(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

TEST_F(Cache, DamagedFilesAreRebuilt) {
    expect_compiled(compile(1));
    const fs::path file = files().at(0);
    const std::string good = read_file(file);
    std::string flipped = good;
    flipped[good.size() / 2] = char(flipped[good.size() / 2] ^ 1);
    std::string old_version = good;
    old_version[4] = char(old_version[4] + 1);
    std::string renamed = good;  // of a driver of another name
    renamed[40] = char(renamed[40] ^ 1);
    for (const std::string& bad :
         {flipped, old_version, renamed, good.substr(0, good.size() - 1), good.substr(0, 10), std::string()}) {
        overwrite(file, bad);
        expect_compiled(compile(1));
        EXPECT_EQ(files().size(), 1u);
        expect_from_cache(compile(1));
    }
}

/// As if someone had given a program the name of another one: the checksum is right.
TEST_F(Cache, SwappedFilesAreCompiledAnew) {
    expect_compiled(compile(1));
    const fs::path of_one = files().at(0);
    expect_compiled(compile(2));
    const fs::path of_two = files().at(0) == of_one ? files().at(1) : files().at(0);
    const std::string one = read_file(of_one);
    overwrite(of_one, read_file(of_two));
    expect_compiled(compile(1));
    expect_from_cache(compile(1));
    overwrite(of_two, one);
    expect_compiled(compile(2));
    expect_from_cache(compile(2));
}

/// The identity in a file, and what follows it.
std::pair<std::string, std::vector<unsigned char>> identity_and_binary(const std::string& file) {
    constexpr std::size_t header_bytes = 32, length_at = 24;  // docs/formats.md
    std::uint32_t length = 0;
    std::memcpy(&length, &file[length_at], sizeof length);
    return {file.substr(header_bytes, length), {file.begin() + header_bytes + length, file.end()}};
}

/// A binary that the driver takes but that lacks the kernel.
TEST_F(Cache, BinariesOfOtherKernelsAreCompiledAnew) {
    if (device().info().platform != "Portable Computing Language") GTEST_SKIP() << "the driver tells no parameters";
    expect_compiled(compile(1));
    const fs::path of_one = files().at(0);
    const Device fresh = Device::open(std::to_string(device().info().index));
    (void)compile_kernel(fresh, "kernel void put(global int* out) { *out = 1; }", "put");
    const fs::path of_other = files().at(0) == of_one ? files().at(1) : files().at(0);
    const auto [identity, good] = identity_and_binary(read_file(of_one));
    const auto [unused, other] = identity_and_binary(read_file(of_other));
    std::vector<unsigned char> mixed(good.begin(), std::find(good.begin(), good.end(), 0));
    mixed.insert(mixed.end(), std::find(other.begin(), other.end(), 0), other.end());
    ASSERT_EQ(store_cached_program(identity, mixed), "");
    expect_compiled(compile(1));
    expect_from_cache(compile(1));
}

/// As if a file came from another machine, or another program had made it with a checksum that seems right.
TEST_F(Cache, FilesWithoutTheFoldersKeyAreCompiledAnew) {
    expect_compiled(compile(1));
    expect_from_cache(compile(1));
    const fs::path key = folder_ / "programs.key";
    EXPECT_EQ(fs::status(key).permissions(), fs::perms::owner_read | fs::perms::owner_write);
    const std::string before = read_file(key);
    for (const std::string& damaged : {std::string(before.size(), 'x'), std::string("short")}) {
        overwrite(key, damaged);
        expect_compiled(compile(1));
        expect_from_cache(compile(1));
    }
    fs::remove(key);
    expect_compiled(compile(1));
    EXPECT_NE(read_file(key), before);
    EXPECT_EQ(read_file(key).size(), before.size());
}

TEST_F(Cache, WhatOthersCanHaveWrittenIsNotTrusted) {
    expect_compiled(compile(1));
    const fs::path file = files().at(0);
    EXPECT_EQ(fs::status(file).permissions(), fs::perms::owner_read | fs::perms::owner_write);
    for (const fs::perms who : {fs::perms::group_write, fs::perms::others_write}) {
        fs::permissions(file, who, fs::perm_options::add);
        expect_compiled(compile(1));
        expect_from_cache(compile(1));
    }
    if (::geteuid() != 0) return;  // only root can give a file away
    ASSERT_EQ(::chown(file.c_str(), 65534, 65534), 0);
    expect_compiled(compile(1));
    expect_from_cache(compile(1));
}

TEST_F(Cache, WhatIsNoFileIsPassedBy) {
    store_cached_program("key", {1});
    const fs::path file = files().at(0);
    fs::remove(file);
    ASSERT_EQ(::mkfifo(file.c_str(), 0600), 0);
    EXPECT_FALSE(load_cached_program("key").has_value());
    EXPECT_EQ(store_cached_program("key", {1}), "");
    EXPECT_EQ(load_cached_program("key"), (std::vector<unsigned char>{1}));
}

TEST_F(Cache, StoredBytesComeBack) {
    const std::vector<unsigned char> bytes = {0, 1, 2, 255, 0};
    EXPECT_FALSE(load_cached_program("key").has_value());
    store_cached_program("key", bytes);
    EXPECT_EQ(load_cached_program("key"), bytes);
    store_cached_program("key", {9});
    EXPECT_EQ(load_cached_program("key"), (std::vector<unsigned char>{9}));
    store_cached_program("empty", {});
    EXPECT_FALSE(load_cached_program("empty").has_value());
}

TEST_F(Cache, AFolderThatCannotBeWrittenIsNoError) {
    const ScopedEnvironment nowhere("CLARAY_CACHE_DIR", "/proc/no/such/folder");
    expect_compiled(compile(1));
    EXPECT_NE(compile_statistics().cache_error.find("cannot create the folder '/proc/no/such/folder'"),
              std::string::npos)
        << compile_statistics().cache_error;
    expect_compiled(compile(1));
    EXPECT_TRUE(files().empty());
}

TEST_F(Cache, ProcessesAtOnceShareTheFolder) {
    std::vector<std::unique_ptr<Process>> processes;
    for (int i = 0; i < 16; ++i)
        processes.push_back(std::make_unique<Process>(
            std::vector<std::string>{this_program(), "--gtest_filter=Program.StructByValueAndClarayHeaders"}));
    for (const auto& process : processes) {
        const ProcessResult result = process->wait();
        EXPECT_EQ(result.exit_code, 0) << result.output << result.errors;
    }
    ASSERT_EQ(files().size(), 1u);  // one program, no temporary file left
}

/// A thread that gets a lock of "some".
class Other {
public:
    explicit Other(const std::string& key)
        : thread_([this, key] {
              const CacheLock lock("some", key);
              has_it_ = true;
          }) {}
    ~Other() { thread_.join(); }
    Other(const Other&) = delete;
    Other& operator=(const Other&) = delete;
    [[nodiscard]] bool has_it() const { return has_it_; }

private:
    std::atomic<bool> has_it_ = false;
    std::thread thread_;
};

TEST_F(Cache, LocksAreOfAKey) {
    const std::string a = hash128("a"), b = hash128("b");
    const auto gets_it_beside = [](const char* group, const std::string& held, const std::string& wanted) {
        auto lock = std::make_unique<CacheLock>(group, held);
        const Other other(wanted);
        const bool got_it = becomes_true([&] { return other.has_it(); });
        lock.reset();
        return got_it;
    };
    EXPECT_TRUE(gets_it_beside("some", a, b));
    EXPECT_TRUE(gets_it_beside("other", a, a));
    auto lock = std::make_unique<CacheLock>("some", a);
    const Other other(a);
    for (int looks = 0; looks < 10; ++looks) {
        EXPECT_FALSE(other.has_it());
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    lock.reset();
    EXPECT_TRUE(becomes_true([&] { return other.has_it(); }));
}

TEST(CacheFolder, FollowsXdgAndHome) {
    const TemporaryFolder folder;
    const ScopedEnvironment no_override("CLARAY_CACHE_DIR", ""), no_xdg("XDG_CACHE_HOME", "");
    const ScopedEnvironment home("HOME", folder.path().string());
    store_cached_program("key", {1});
    EXPECT_TRUE(fs::exists(folder.path() / ".cache/claray" / (hash128("key") + ".bin")));
    const ScopedEnvironment xdg("XDG_CACHE_HOME", (folder / "xdg").string());
    store_cached_program("key", {1});
    EXPECT_TRUE(fs::exists(folder.path() / "xdg/claray" / (hash128("key") + ".bin")));
}

TEST(Hash, IsXxh3With128Bits) {
    EXPECT_EQ(hash128(""), "99aa06d3014798d86001c324468d497f");  // of the empty input, from the XXH3 specification
    EXPECT_NE(hash128("a"), hash128("b"));
}

}  // namespace
}  // namespace claray::test
