#include "host/render/checkpoint.hpp"

#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>

#include "host/compute/file.hpp"
#include "host/compute/kernel_sources.hpp"
#include "host/render/scene_digest.hpp"

namespace claray {
namespace {

constexpr std::array<char, 8> magic = {'C', 'L', 'R', 'C', 'K', 'P', '\r', '\n'};
constexpr std::uint32_t current_version = 3;
constexpr std::uint32_t byte_order = 0x01020304;  // reads otherwise on a machine of the other byte order

/// The beginning of a file. Then the film's pixels, and their digest.
struct FileHeader {
    std::array<char, 8> name;
    std::uint32_t version;
    std::uint32_t order;
    std::uint32_t pixel_bytes;
    std::uint32_t width, height;
    Schedule::Position position;
    std::uint32_t more_films;  // than one
    ErrorLooks looks;
    Digest scene, settings, kernels;
    Digest digest;  // of this header up to here
};
static_assert(sizeof(FileHeader) == 144);

std::uint64_t pixels_of(const FileHeader& header) {
    return std::uint64_t(header.width) * header.height * (1 + std::uint64_t(header.more_films));
}

Digest digest_of_header(const FileHeader& header) { return digest_of(&header, offsetof(FileHeader, digest)); }

class CheckpointFile {
public:
    explicit CheckpointFile(const std::filesystem::path& path) : path_(path) {
        std::error_code none;
        if (std::filesystem::is_directory(path, none)) refuse("it is a folder", "name a file");
        file_.open(path, std::ios::binary | std::ios::ate);
        if (!file_) refuse(std::strerror(errno), "check the path");
        bytes_ = std::uint64_t(file_.tellg());
        file_.seekg(0);
    }

    [[nodiscard]] FileHeader header() {
        FileHeader header{};
        const std::uint64_t whole = std::min<std::uint64_t>(bytes_, sizeof header);
        read(&header, whole);
        if (whole < magic.size() || header.name != magic)
            refuse("it is no checkpoint", "name a file that --checkpoint wrote");
        if (whole < sizeof header) refuse_damaged("it ends too early");
        if (header.order != byte_order)
            refuse("it was written on a machine of another byte order", "render from the start");
        if (header.version != current_version || header.pixel_bytes != sizeof(FilmPixel))
            refuse("it was written by another version of claray", "use that version, or render from the start");
        if (header.digest != digest_of_header(header)) refuse_damaged("the checksum of its header is wrong");
        const std::uint64_t expected = sizeof header + pixels_of(header) * sizeof(FilmPixel) + sizeof(Digest);
        if (bytes_ != expected)
            refuse_damaged("it has " + std::to_string(bytes_) + " bytes instead of " + std::to_string(expected));
        return header;
    }

    [[nodiscard]] std::vector<FilmPixel> pixels(std::size_t count) {
        std::vector<FilmPixel> pixels(count);
        read(pixels.data(), count * sizeof(FilmPixel));
        Digest digest;
        read(digest.data(), digest.size());
        if (digest != digest_of(pixels.data(), count * sizeof(FilmPixel))) refuse_damaged("its checksum is wrong");
        return pixels;
    }

    [[noreturn]] void refuse_damaged(const std::string& why) const {
        refuse("the file is damaged: " + why, "render from the start");
    }
    [[noreturn]] void refuse(const std::string& why, const std::string& remedy) const {
        throw Error(ErrorKind::user, "cannot go on from '" + path_.string() + "': " + why, remedy);
    }

private:
    void read(void* data, std::uint64_t bytes) {
        if (!file_.read(static_cast<char*>(data), std::streamsize(bytes))) refuse("read error", "check the disk");
    }

    std::filesystem::path path_;
    std::ifstream file_;
    std::uint64_t bytes_ = 0;
};

std::string size_of(std::uint32_t width, std::uint32_t height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace

RenderIdentity identity_of(const Scene& scene, const RenderConfig& config) {
    RenderIdentity identity{config.width, config.height, films_of(config), digest_of(scene), {}, {}};
    const std::string settings = std::to_string(config.seed) + ' ' + std::to_string(config.max_depth) + ' ' +
                                 std::to_string(int(config.sampler)) + ' ' + to_string(config.effects.remove);
    identity.settings = digest_of(settings.data(), settings.size());
    Hasher kernels;
    for (const KernelSource& source : kernel_sources()) {
        kernels.add(source.path.data(), source.path.size());
        kernels.add(source.text.data(), source.text.size());
    }
    identity.kernels = kernels.digest();
    return identity;
}

void write_checkpoint(const std::filesystem::path& path, const RenderIdentity& identity, const Checkpoint& checkpoint) {
    FileHeader header{};
    header.name = magic;
    header.version = current_version;
    header.order = byte_order;
    header.pixel_bytes = sizeof(FilmPixel);
    header.width = identity.width, header.height = identity.height;
    header.position = checkpoint.position;
    header.more_films = identity.films - 1;
    header.looks = checkpoint.looks;
    header.scene = identity.scene, header.settings = identity.settings, header.kernels = identity.kernels;
    header.digest = digest_of_header(header);
    const std::size_t bytes = checkpoint.pixels.size() * sizeof(FilmPixel);
    const Digest digest = digest_of(checkpoint.pixels.data(), bytes);
    NewFile file(path);
    file.write(&header, sizeof header);
    file.write(checkpoint.pixels.data(), bytes);
    file.write(digest.data(), digest.size());
    file.commit();
}

Checkpoint read_checkpoint(const std::filesystem::path& path, const RenderIdentity& identity, std::uint32_t spp) {
    CheckpointFile file(path);
    const FileHeader header = file.header();
    if (header.width != identity.width || header.height != identity.height)
        file.refuse("its image has " + size_of(header.width, header.height) + " pixels, this one " +
                        size_of(identity.width, identity.height),
                    "give the same --size");
    if (header.scene != identity.scene)
        file.refuse("it is of another scene or camera", "give the scene and the camera that it was written for");
    if (header.settings != identity.settings)
        file.refuse("it was rendered with another seed, depth, sampler or choice of effects", "give the same settings");
    if (header.more_films + 1 != identity.films)
        file.refuse(identity.films == 1 ? "it was rendered with --error, and has sums for it"
                                        : "it was rendered without --error",
                    identity.films == 1 ? "give --error, too" : "leave out --error, or render from the start");
    if (header.kernels != identity.kernels)
        file.refuse("it was written by a claray with other kernels", "use that version, or render from the start");
    const Schedule::Position& at = header.position;
    const bool within = at.pixel != 0 || at.sample != 0;
    if (at.pixel >= header.width * header.height || (within && at.sample >= at.pass))
        file.refuse_damaged("it stops where no image does");
    const std::uint64_t most = std::uint64_t(at.done) + (within ? at.pass : 0);
    if (most > spp)
        file.refuse(
            "it has " + std::to_string(most) + " samples a pixel, and " + std::to_string(spp) + " are asked for",
            "give a larger --spp");
    const ErrorLooks& looks = header.looks;
    const auto sound = [](double value) { return value >= 0 && std::isfinite(value); };
    if (!(sound(looks.square) && sound(looks.degrees) && sound(looks.last)) || looks.spp > at.done)
        file.refuse_damaged("what it knows of the error is no number");
    return {at, looks, file.pixels(pixels_of(header))};
}

}  // namespace claray
