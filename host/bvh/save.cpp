// Saves a built structure to a file and loads it. docs/formats.md describes the bytes.
#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>

#include "host/base/file.hpp"
#include "host/base/hash.hpp"
#include "host/bvh/bvh_state.hpp"
#include "host/bvh/require_memory.hpp"
#include "host/bvh/saved_tree.hpp"

namespace claray {
namespace {

constexpr std::array<char, 8> tree_magic = {'C', 'L', 'R', 'B', 'V', 'H', '\r', '\n'};
constexpr std::uint32_t tree_version = 2;
/// Sizes of the structs in the arrays: a file with other sizes cannot be read.
constexpr std::uint32_t struct_sizes = sizeof(BvhNode) << 16 | sizeof(LeafTriangle) << 8 | sizeof(BvhHeader);
constexpr std::size_t chunk_bytes = std::size_t(16) << 20;

/// The beginning of a file. Then the arrays in the order of their counts, and the digest of all that follows the
/// header.
struct TreeHeader {
    std::array<char, 8> name;
    std::uint32_t version;
    std::uint32_t order;
    std::uint32_t structs;
    std::uint32_t builder;
    std::uint32_t morton_bits;
    std::uint32_t leaf_limit;  // triangles per leaf, in the upper 16 bits; the lower bits are not read
    std::uint64_t file_bytes;
    std::uint64_t nodes, leaves, positions, indices, geometries, masks;  // elements
    BvhHeader bvh;
    Digest digest;  // of this header up to here
};
static_assert(sizeof(TreeHeader) == 168);

Digest digest_of_tree_header(const TreeHeader& header) { return digest_of(&header, offsetof(TreeHeader, digest)); }

/// Writes a buffer in pieces, so that it need not fit in host memory.
template <class T>
void write_buffer(NewFile& file, Hasher& hasher, const Buffer<T>& buffer) {
    std::vector<T> chunk;
    for (std::size_t done = 0; done < buffer.size(); done += chunk.size()) {
        chunk.resize(std::min(buffer.size() - done, chunk_bytes / sizeof(T)));
        buffer.read(std::span<T>(chunk), done);
        hasher.add(chunk.data(), chunk.size() * sizeof(T));
        file.write(chunk.data(), chunk.size() * sizeof(T));
    }
}

/// A saved structure that is being read. Each error names the file and the remedy.
class SavedFile {
public:
    explicit SavedFile(const std::filesystem::path& path) : path_(path), file_(path, std::ios::binary | std::ios::ate) {
        std::error_code none;
        if (std::filesystem::is_directory(path, none)) refuse("it is a folder", "name a file");
        if (!file_) refuse(std::strerror(errno), "check the path");
        bytes_ = std::uint64_t(file_.tellg());
        file_.seekg(0);
        read_header();
    }

    [[nodiscard]] const TreeHeader& header() const { return header_; }

    /// Reads the first `count` elements of a buffer; calls `look` with each piece.
    template <class T, class Look>
    void fill(Buffer<T>& buffer, std::uint64_t count, const Look& look) {
        std::vector<T> chunk;
        for (std::uint64_t done = 0; done < count; done += chunk.size()) {
            chunk.resize(std::min<std::uint64_t>(count - done, chunk_bytes / sizeof(T)));
            read(chunk.data(), chunk.size() * sizeof(T));
            hasher_.add(chunk.data(), chunk.size() * sizeof(T));
            look(std::span<const T>(chunk));
            buffer.write(std::span<const T>(chunk), done);
        }
    }

    void check_digest() {
        Digest digest;
        read(digest.data(), digest.size());
        if (digest != hasher_.digest()) refuse_damaged("its checksum is wrong");
    }

    [[noreturn]] void refuse_damaged(const std::string& why) const {
        refuse("the file is damaged: " + why, "build the structure again and save it");
    }

private:
    [[noreturn]] void refuse(const std::string& why, const std::string& remedy) const {
        throw Error(ErrorKind::user, "cannot load '" + path_.string() + "': " + why, remedy);
    }

    void read(void* data, std::size_t bytes) {
        if (!file_.read(static_cast<char*>(data), std::streamsize(bytes))) refuse_damaged("it ends too early");
    }

    void read_header() {
        if (bytes_ < sizeof(TreeHeader)) {
            std::array<char, 8> begin{};
            file_.read(begin.data(), begin.size());
            if (!std::equal(begin.begin(), begin.begin() + file_.gcount(), tree_magic.begin()) || file_.gcount() == 0)
                refuse_stranger();
            refuse_damaged("it ends too early");
        }
        read(&header_, sizeof header_);
        if (header_.name != tree_magic) refuse_stranger();
        if (header_.order != byte_order)
            refuse("it was written on a machine with a different byte order", "build the structure on this machine");
        if (header_.version != tree_version)
            refuse("it has format " + std::to_string(header_.version) + ", but this claray reads format " +
                       std::to_string(tree_version),
                   header_.version > tree_version ? "use a newer claray, or build the structure again"
                                                  : "build the structure again and save it");
        if (header_.digest != digest_of_tree_header(header_)) refuse_damaged("the checksum of its header is wrong");
        if (header_.structs != struct_sizes)
            refuse("its nodes or triangles have a different layout", "build the structure again and save it");
        if (header_.file_bytes != bytes_)
            refuse_damaged("it has " + std::to_string(bytes_) + " bytes instead of " +
                           std::to_string(header_.file_bytes));
        if (!holds_its_arrays()) refuse_damaged("the sizes of its arrays do not match the file size");
    }

    /// Checks the sizes of arrays against the file's size before any memory is allocated.
    [[nodiscard]] bool holds_its_arrays() const {
        std::uint64_t left = bytes_ - sizeof header_;
        const auto take = [&](std::uint64_t count, std::size_t size) {
            const bool fits = count <= left / size;
            left -= fits ? count * size : 0;
            return fits;
        };
        return take(header_.nodes, sizeof(BvhNode)) && take(header_.leaves, sizeof(LeafTriangle)) &&
               take(header_.positions, sizeof(float)) && take(header_.indices, sizeof(std::uint32_t)) &&
               take(header_.geometries, sizeof(std::uint32_t)) && take(header_.masks, sizeof(std::uint32_t)) &&
               left == sizeof(Digest);
    }

    [[noreturn]] void refuse_stranger() const {
        refuse("it is not a saved structure", "give a file written by Bvh::save");
    }

    std::filesystem::path path_;
    std::ifstream file_;
    std::uint64_t bytes_ = 0;
    TreeHeader header_{};
    Hasher hasher_;
};

}  // namespace

void Bvh::save(const std::filesystem::path& path) const {
    require_triangles(*this, "a saved tree");
    const State& s = *state_;
    TreeHeader header{};
    header.name = tree_magic;
    header.version = tree_version;
    header.order = byte_order;
    header.structs = struct_sizes;
    header.builder = std::uint32_t(s.config.builder);
    header.morton_bits = s.config.morton_bits;
    header.leaf_limit = Bvh::State::leaf_limit(s.config) << 16;
    header.nodes = s.nodes.size();
    header.leaves = s.leaves.size();
    header.positions = s.triangles.positions.size();
    header.indices = s.triangles.indices.size();
    header.geometries = s.triangles.geometries.size();
    header.masks = s.triangles.masks.size();
    header.bvh = s.read_header();
    header.file_bytes = sizeof header + s.nodes.bytes() + s.leaves.bytes() + s.triangles.positions.bytes() +
                        s.triangles.indices.bytes() + s.triangles.geometries.bytes() + s.triangles.masks.bytes() +
                        sizeof(Digest);
    header.digest = digest_of_tree_header(header);

    NewFile file(path);
    Hasher hasher;
    file.write(&header, sizeof header);
    write_buffer(file, hasher, s.nodes);
    write_buffer(file, hasher, s.leaves);
    write_buffer(file, hasher, s.triangles.positions);
    write_buffer(file, hasher, s.triangles.indices);
    write_buffer(file, hasher, s.triangles.geometries);
    write_buffer(file, hasher, s.triangles.masks);
    const Digest digest = hasher.digest();
    file.write(digest.data(), digest.size());
    file.commit();
}

namespace {

/// Returns the split budget of a build that allocated so many leaves.
double split_budget_of(const TreeHeader& header) {
    const auto triangles = double(header.indices / 3);
    return triangles > 0 ? std::max(0.0, (double(header.leaves) - triangles + 0.5) / triangles) : 0.0;
}

Bvh::Config config_of(const SavedFile& file, Layout layout) {
    const TreeHeader& header = file.header();
    const std::uint32_t most_in_leaf = header.leaf_limit >> 16;
    if (header.builder >= std::size(builders) || (header.morton_bits != 30 && header.morton_bits != 63) ||
        most_in_leaf < 1 || most_in_leaf > CLARAY_BLOCK)
        file.refuse_damaged("its builder settings are invalid");
    Bvh::Config config;
    config.builder = Builder(header.builder);
    config.morton_bits = header.morton_bits;
    config.layout = layout;
    config.max_leaf_triangles = most_in_leaf;
    if (traits_of(config.builder).splits) config.split_budget = split_budget_of(header);
    return config;
}

TriangleCounts counts_of(const SavedFile& file) {
    const TreeHeader& h = file.header();
    if (h.positions % 3 != 0 || h.indices % 3 != 0 || (h.geometries != 0 && h.geometries != h.indices / 3))
        file.refuse_damaged("the sizes of its arrays do not match each other");
    return {h.positions, h.indices, h.geometries, h.masks};
}

/// Reads the arrays in the order in which they were written, and checks all indices.
void read_arrays(SavedFile& file, Bvh::State& s) {
    const TreeHeader& h = file.header();
    SavedTree tree(h.nodes, h.leaves, h.geometries);
    const auto nothing = [](auto) {};
    const auto add = [&](auto piece) { tree.add(piece); };
    file.fill(s.nodes, h.nodes, add);
    file.fill(s.leaves, h.leaves, add);
    file.fill(s.triangles.positions, h.positions, nothing);
    file.fill(s.triangles.indices, h.indices, [&](auto piece) { tree.add_indices(piece); });
    file.fill(s.triangles.geometries, h.geometries, [&](auto piece) { tree.add_geometries(piece); });
    file.fill(s.triangles.masks, h.masks, [&](auto piece) { tree.add_masks(piece); });
    file.check_digest();
    const SavedTree::Counts counts = {.triangles = s.count,
                                      .vertices = h.positions / 3,
                                      .most_in_leaf = s.config.max_leaf_triangles,
                                      .splits = traits_of(s.config.builder).splits};
    if (const std::string fault = tree.fault(h.bvh, counts); !fault.empty()) file.refuse_damaged(fault);
}

}  // namespace

Bvh Bvh::load(const Device& device, const std::filesystem::path& path, Layout layout) {
    SavedFile file(path);
    const TreeHeader& header = file.header();
    const Config config = config_of(file, layout);
    const TriangleCounts counts = counts_of(file);
    require_memory(device, counts, config);
    Bvh bvh;
    commit_memory(device, counts, config,
                  [&] { bvh.state_ = std::make_shared<State>(device, allocate_triangles(device, counts), config); });
    State& s = *bvh.state_;
    if (s.nodes.size() != header.nodes || s.leaves.size() != header.leaves)
        file.refuse_damaged("its tree and its triangles do not match");
    read_arrays(file, s);
    BvhHeader alone = header.bvh;
    alone.first_node = alone.first_leaf = 0;  // kernels add these to their pointers
    s.header.write(std::span(&alone, 1));
    if (s.layout == Layout::wide && config.max_leaf_triangles > 1)
        s.build();  // the wide tree has its own leaves
    else if (s.layout == Layout::wide)
        s.collapse(false);
    return bvh;
}

}  // namespace claray
