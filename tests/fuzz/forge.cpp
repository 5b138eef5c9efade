#include "tests/fuzz/forge.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <random>
#include <string>

#include "host/base/hash.hpp"

namespace claray::test {
namespace {

/// Counts, indices, references and floats at the edges of what they may be.
constexpr std::uint32_t edges[] = {0,          1,          2,          3,          4,          0xff,
                                   0x100,      0xffff,     0x10000,    0x00ffffff, 0x1fffffff, 0x20000000,
                                   0x55555555, 0x7f7fffff, 0x7f800000, 0x7fc00000, 0x7fffffff, 0x80000000,
                                   0x9fffffff, 0xff800000, 0xfffffffe, 0xffffffff};

class Forger {
public:
    Forger(std::span<const std::uint8_t> good, std::uint32_t number, std::size_t header)
        : file_(good.begin(), good.end()), header_(std::min(header, good.size())), random_(number) {}

    FileBytes run() {
        for (std::uint32_t changes = 1 + below(4); changes != 0 && file_.size() >= 16; --changes) change();
        return std::move(file_);
    }

private:
    /// The same on every platform, which standard distributions are not.
    std::uint32_t below(std::size_t end) { return std::uint32_t(random_() % std::max<std::size_t>(end, 1)); }

    /// Where words lie: at a multiple of four.
    std::size_t place(std::size_t bytes) {
        const bool in_header = below(2) == 0;
        const std::size_t begin = in_header ? 0 : std::min(header_, file_.size()),
                          end = in_header ? std::min(header_, file_.size()) : file_.size();
        if (end < begin + bytes) return 0;
        return begin + below((end - begin - bytes) / 4 + 1) * 4;
    }

    std::uint32_t word(std::size_t at) const {
        std::uint32_t value = 0;
        std::memcpy(&value, &file_[at], sizeof value);
        return value;
    }
    void set(std::size_t at, std::uint32_t value) { std::memcpy(&file_[at], &value, sizeof value); }

    void change() {
        switch (below(16)) {
            case 0: file_[below(file_.size())] ^= std::uint8_t(1u << below(8)); break;
            case 1: set(place(4), random_()); break;
            case 2: cut_or_lengthen(); break;
            case 3: {  // a number of 8 bytes
                const std::size_t at = place(8);
                set(at, edges[below(std::size(edges))]), set(at + 4, edges[below(std::size(edges))]);
                break;
            }
            case 4: copy_block(); break;
            case 5:
            case 6:
            case 7: set(place(4), edges[below(std::size(edges))]); break;
            case 8:
            case 9:
            case 10: set(place(4), word(place(4))); break;  // from elsewhere
            case 11:
            case 12: {
                const std::size_t at = place(4);
                set(at, word(at) + (below(2) == 0 ? 1u : 0xffffffffu) * (1 + below(3)));
                break;
            }
            default: {  // another of the numbers that may be meant
                const std::size_t at = place(4);
                set(at, below(2) == 0 ? below(256) : (word(at) & 0xff000000u) | below(1024));
            }
        }
    }

    void copy_block() {
        const std::size_t bytes = std::min<std::size_t>(std::size_t(4) << below(5), file_.size() / 2);
        const std::size_t from = place(bytes), to = place(bytes);
        const FileBytes block(file_.begin() + std::ptrdiff_t(from), file_.begin() + std::ptrdiff_t(from + bytes));
        std::copy(block.begin(), block.end(), file_.begin() + std::ptrdiff_t(to));
    }

    void cut_or_lengthen() {
        if (below(2) == 0)
            file_.resize(file_.size() - below(file_.size() / 2));
        else
            file_.resize(file_.size() + 4 * below(64), std::uint8_t(random_()));
    }

    FileBytes file_;
    std::size_t header_;
    std::mt19937 random_;
};

std::uint64_t largest_size_in_memory() {
    struct rusage usage = {};
    getrusage(RUSAGE_SELF, &usage);
    return std::uint64_t(usage.ru_maxrss) * 1024;
}

}  // namespace

FileBytes forged(std::span<const std::uint8_t> good, std::uint32_t number, std::size_t header) {
    return Forger(good, number, header).run();
}

void mend_digest(FileBytes& file, std::size_t begin, std::size_t end) {
    if (begin > end || file.size() < end + sizeof(Digest)) return;
    const Digest digest = digest_of(file.data() + begin, end - begin);
    std::memcpy(file.data() + end, digest.data(), digest.size());
}

void mend_digests(FileBytes& file, std::size_t header) {
    mend_digest(file, 0, header - sizeof(Digest));
    if (file.size() >= header + sizeof(Digest)) mend_digest(file, header, file.size() - sizeof(Digest));
}

void mend_tree(FileBytes& file) {
    constexpr std::size_t at_size = 32;
    const std::uint64_t size = file.size();
    if (file.size() >= at_size + sizeof size) std::memcpy(file.data() + at_size, &size, sizeof size);
    mend_digests(file, tree_header);
}

std::uint32_t forged_count(std::uint32_t otherwise) {
    const char* wanted = std::getenv("CLARAY_FORGED");
    return wanted != nullptr && *wanted != '\0' ? std::uint32_t(std::stoul(wanted)) : otherwise;
}

ForgedOutcome try_forged(const std::vector<FileBytes>& good, std::uint32_t count, std::size_t header,
                         const std::function<void(FileBytes&)>& mend,
                         const std::function<bool(std::span<const std::uint8_t>)>& use) {
    ForgedOutcome outcome;
    for (const FileBytes& file : good) (void)use(file);  // whatever is loaded and compiled once
    const std::uint64_t before = largest_size_in_memory();
    for (std::uint32_t number = 0; number < count; ++number) {
        FileBytes file = forged(good[number % good.size()], number, header);
        mend(file);
        ++(use(file) ? outcome.read : outcome.refused);
    }
    outcome.grown_bytes = largest_size_in_memory() - before;
    return outcome;
}

}  // namespace claray::test
