// Writing files: all or nothing, and every failure named.
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <csignal>

#include "claray/io.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/support/process.hpp"

namespace claray {
namespace {

namespace fs = std::filesystem;
using test::expect_error;
using test::TemporaryFolder;

/// Lets no file grow beyond `bytes`: writes then fail as they do on a full disk, whoever runs the test.
class FileSizeLimit {
public:
    explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
        ::getrlimit(RLIMIT_FSIZE, &before_);
        const rlimit limit = {bytes, before_.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    }
    ~FileSizeLimit() {
        ::setrlimit(RLIMIT_FSIZE, &before_);
        std::signal(SIGXFSZ, handler_);
    }
    FileSizeLimit(const FileSizeLimit&) = delete;
    FileSizeLimit& operator=(const FileSizeLimit&) = delete;

private:
    rlimit before_{};
    void (*handler_)(int);
};

const Image small_image{2, 1, {glm::vec3(0.5f), glm::vec3(1.f)}};

TEST(File, IsWrittenWholeAndReplaced) {
    const TemporaryFolder folder;
    const std::string large(1 << 20, 'x');
    write_file(folder / "a", large);
    EXPECT_EQ(test::read_file(folder / "a"), large);
    write_file(folder / "a", std::string("b\0c", 3));
    EXPECT_EQ(test::read_file(folder / "a"), std::string("b\0c", 3));
    write_file(folder / "empty", "");
    EXPECT_EQ(fs::file_size(folder / "empty"), 0u);
    EXPECT_EQ(folder.entries(), 2u) << "no temporary file stays";
}

TEST(File, PermissionsFollowTheUmask) {
    const TemporaryFolder folder;
    const mode_t before = ::umask(027);
    write_file(folder / "a", "x");
    ::umask(before);
    EXPECT_EQ(int(fs::status(folder / "a").permissions()), 0640);
}

TEST(File, MissingFolderIsAnError) {
    const TemporaryFolder folder;
    const fs::path path = folder / "none" / "a.png";
    expect_error(ErrorKind::user, {"none/a.png", "No such file", "create the folder"},
                 [&] { write_image(path, small_image); });
    expect_error(ErrorKind::user, {"none/a.png"}, [&] { check_writable(path); });
}

TEST(File, FolderThatIsAFileIsAnError) {
    const TemporaryFolder folder;
    const fs::path path = folder.file("plain", "x") / "a.png";
    expect_error(ErrorKind::user, {"plain/a.png", "Not a directory"}, [&] { write_image(path, small_image); });
    expect_error(ErrorKind::user, {"plain/a.png"}, [&] { check_writable(path); });
}

TEST(File, ReadOnlyFolderIsAnError) {
    // /proc takes no new file, not even from root.
    expect_error(ErrorKind::user, {"/proc/a.png"}, [&] { write_image("/proc/a.png", small_image); });
    expect_error(ErrorKind::user, {"/proc/a.png"}, [&] { check_writable("/proc/a.png"); });
    if (::geteuid() == 0) return;
    const TemporaryFolder folder;
    fs::create_directory(folder / "locked");
    fs::permissions(folder / "locked", fs::perms::owner_read | fs::perms::owner_exec);
    expect_error(ErrorKind::user, {"locked/a.png", "Permission denied", "writable folder"},
                 [&] { check_writable(folder / "locked" / "a.png"); });
}

TEST(File, FolderInPlaceOfAFileIsAnError) {
    const TemporaryFolder folder;
    fs::create_directory(folder / "a.png");
    expect_error(ErrorKind::user, {"a.png", "Is a directory"}, [&] { write_image(folder / "a.png", small_image); });
    expect_error(ErrorKind::user, {"a.png"}, [&] { check_writable(folder / "a.png"); });
    expect_error(ErrorKind::user, {"cannot write"}, [&] { write_file("", "x"); });
    EXPECT_EQ(folder.entries(), 1u);
}

TEST(File, FullDiskLeavesTheOldFileAndNothingElse) {
    const TemporaryFolder folder;
    write_file(folder / "a.pfm", "old");
    const Image image{100, 100, std::vector<glm::vec3>(10000)};  // 120,000 bytes
    {
        const FileSizeLimit limit(4096);
        expect_error(ErrorKind::user, {"a.pfm", "free some space"}, [&] { write_image(folder / "a.pfm", image); });
        expect_error(ErrorKind::user, {"new.pfm"}, [&] { write_image(folder / "new.pfm", image); });
    }
    EXPECT_EQ(test::read_file(folder / "a.pfm"), "old");
    EXPECT_EQ(folder.entries(), 1u);
    write_image(folder / "a.pfm", image);
    EXPECT_GT(fs::file_size(folder / "a.pfm"), 120000u);
}

TEST(File, DevicesAreWrittenToAndNeverReplaced) {
    expect_error(ErrorKind::user, {"/dev/full", "No space left", "free some space"},
                 [&] { write_file("/dev/full", "x"); });
    EXPECT_TRUE(fs::is_character_file("/dev/full"));
    write_file("/dev/null", "x");
    EXPECT_TRUE(fs::is_character_file("/dev/null"));

    const TemporaryFolder folder;
    fs::create_symlink("/dev/full", folder / "full.png");
    expect_error(ErrorKind::user, {"full.png", "No space left"},
                 [&] { write_image(folder / "full.png", small_image); });
    EXPECT_TRUE(fs::is_symlink(folder / "full.png"));
}

TEST(File, LinksAreFollowed) {
    const TemporaryFolder folder;
    write_file(folder / "target.png", "old");
    fs::create_symlink("target.png", folder / "link.png");
    write_image(folder / "link.png", small_image);
    EXPECT_TRUE(fs::is_symlink(folder / "link.png"));
    EXPECT_EQ(test::read_file(folder / "target.png").substr(1, 3), "PNG");
}

TEST(File, CheckingLeavesNoTrace) {
    const TemporaryFolder folder;
    check_writable(folder / "a.png");
    EXPECT_EQ(folder.entries(), 0u);
    write_file(folder / "a.png", "old");
    check_writable(folder / "a.png");
    EXPECT_EQ(test::read_file(folder / "a.png"), "old");
}

}  // namespace
}  // namespace claray
