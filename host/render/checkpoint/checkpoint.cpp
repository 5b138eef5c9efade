#include "host/render/checkpoint/checkpoint.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <fstream>

#include "claray/shared/path.h"
#include "host/base/file.hpp"
#include "host/base/format.hpp"
#include "host/compute/programs/kernel_sources.hpp"
#include "host/render/checkpoint/scene_digest.hpp"
#include "host/render/guiding/path_guide.hpp"

namespace claray {
namespace {

constexpr std::array<char, 8> checkpoint_magic = {'C', 'L', 'R', 'C', 'K', 'P', '\r', '\n'};
constexpr std::uint32_t checkpoint_version = 7;

/// The beginning of a file. Then the film's sums, the control pixels, the half tiles of adaptive sampling, the pending
/// batches, and the digest of these.
struct CheckpointHeader {
    std::array<char, 8> name;
    std::uint32_t version;
    std::uint32_t order;
    std::uint32_t pixel_bytes;
    std::uint32_t width, height;
    PassSchedule::Position position;
    std::uint32_t controls;  // number of control pixels
    std::uint32_t halves;    // number of half tiles, see AdaptiveSchedule::Position
    std::uint32_t error_spp;
    ErrorEstimate error;
    double error_power;
    Digest scene, settings, kernels;
    Digest digest;  // of this header up to here
};
static_assert(sizeof(CheckpointHeader) == 152 && sizeof(ControlPixel) == 8 + sizeof(FilmPixel));

std::uint64_t pixels_of(const CheckpointHeader& header) { return std::uint64_t(header.width) * header.height; }

std::uint64_t bytes_of_sums(const CheckpointHeader& header) {
    return pixels_of(header) * sizeof(FilmPixel) + header.controls * std::uint64_t(sizeof(ControlPixel));
}

template <class T>
std::size_t bytes_of(const std::vector<T>& values) {
    return values.size() * sizeof(T);
}

/// Calls visit(values) for each part that follows the header.
template <class CheckpointOrConst, class Visit>
void visit_parts(CheckpointOrConst& checkpoint, const Visit& visit) {
    visit(checkpoint.sums), visit(checkpoint.error.controls);
    visit(checkpoint.position.halves), visit(checkpoint.position.pending);
}

Digest digest_of_parts(const Checkpoint& checkpoint) {
    Hasher hasher;
    visit_parts(checkpoint, [&](const auto& values) { hasher.add(values.data(), bytes_of(values)); });
    return hasher.digest();
}

Digest digest_of_checkpoint_header(const CheckpointHeader& header) {
    return digest_of(&header, offsetof(CheckpointHeader, digest));
}

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

    [[nodiscard]] CheckpointHeader header() {
        CheckpointHeader header{};
        const std::uint64_t whole = std::min<std::uint64_t>(bytes_, sizeof header);
        read(&header, whole);
        if (whole < checkpoint_magic.size() || header.name != checkpoint_magic)
            refuse("it is not a checkpoint", "give a file written by --checkpoint");
        if (whole < sizeof header) refuse_damaged("it ends too early");
        if (header.order != byte_order)
            refuse("it was written on a machine with a different byte order", "render from the start");
        if (header.version != checkpoint_version || header.pixel_bytes != sizeof(FilmPixel))
            refuse("it was written by another version of claray", "use that version, or render from the start");
        if (header.digest != digest_of_checkpoint_header(header)) refuse_damaged("the checksum of its header is wrong");
        const std::uint64_t of_halves = header.halves * std::uint64_t(sizeof(std::uint32_t));
        const std::uint64_t expected = sizeof header + bytes_of_sums(header) + of_halves + sizeof(Digest);
        const bool ends_in_batches = bytes_ > expected && (bytes_ - expected) % sizeof(Batch) == 0;
        pending_ = ends_in_batches ? (bytes_ - expected) / sizeof(Batch) : 0;
        if (bytes_ != expected && pending_ == 0)
            refuse_damaged("it has " + std::to_string(bytes_) + " bytes instead of " + std::to_string(expected));
        return header;
    }

    /// Reads what follows the header.
    void read_rest(const CheckpointHeader& header, Checkpoint& checkpoint) {
        checkpoint.sums.resize(pixels_of(header)), checkpoint.error.controls.resize(header.controls);
        checkpoint.position.halves.resize(header.halves), checkpoint.position.pending.resize(pending_);
        visit_parts(checkpoint, [&](auto& values) { read(values.data(), bytes_of(values)); });
        Digest digest;
        read(digest.data(), digest.size());
        if (digest != digest_of_parts(checkpoint)) refuse_damaged("its checksum is wrong");
    }

    [[noreturn]] void refuse_damaged(const std::string& why) const {
        refuse("the file is damaged: " + why, "render from the start");
    }
    [[noreturn]] void refuse(const std::string& why, const std::string& remedy) const {
        throw Error(ErrorKind::user, "cannot continue from '" + path_.string() + "': " + why, remedy);
    }

private:
    void read(void* data, std::uint64_t bytes) {
        if (!file_.read(static_cast<char*>(data), std::streamsize(bytes))) refuse("read error", "check the disk");
    }

    std::filesystem::path path_;
    std::ifstream file_;
    std::uint64_t bytes_ = 0, pending_ = 0;  // number of pending batches
};

/// Whether each pixel has at most one pending batch, of samples that end where the whole image is between two passes.
bool are_before(const std::vector<Batch>& pending, const CheckpointHeader& header) {
    std::uint64_t next = 0;  // pixel
    const PassSchedule::Position& at = header.position;
    for (const Batch& batch : pending) {
        const bool sound = batch.first_pixel >= next && batch.pixels > 0 && batch.samples > 0 && batch.listed == 0 &&
                           std::uint64_t(batch.first_sample) + batch.samples == at.done;
        next = std::uint64_t(batch.first_pixel) + batch.pixels;
        if (!sound || next > pixels_of(header)) return false;
    }
    return pending.empty() || (at.pixel == 0 && at.sample == 0 && header.halves == 0);
}

bool are_sound(const std::vector<ControlPixel>& controls, const CheckpointHeader& header) {
    return std::ranges::all_of(controls, [&](const ControlPixel& control) {
        return control.pixel < pixels_of(header) && control.chance > 0 && control.chance <= 1;
    });
}

std::string size_of(std::uint32_t width, std::uint32_t height) {
    return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace

RenderIdentity identity_of(const Scene& scene, const RenderConfig& config) {
    RenderIdentity identity{config.image_width(), config.image_height(), digest_of(scene), {}, {}};
    const Region& part = config.region;
    const std::string region =
        part.width == 0 ? "" : printed(" region %u,%u of %ux%u", part.x, part.y, config.width, config.height);
    const std::string settings = std::to_string(config.seed) + ' ' + std::to_string(config.max_depth) + ' ' +
                                 std::to_string(int(config.sampler)) + ' ' + to_string(config.effects.remove) + ' ' +
                                 to_string(config.approximate) + (config.adaptive ? " adaptive" : "") +
                                 (PathGuide::is_for(config) ? " guide" : "") +
                                 (config.sample_clamp > 0 ? printed(" clamp %a", double(config.sample_clamp)) : "") +
                                 (config.approximate.light_grid ? ' ' + to_string(config.light_grid) : "") + region;
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
    CheckpointHeader header{};
    header.name = checkpoint_magic;
    header.version = checkpoint_version;
    header.order = byte_order;
    header.pixel_bytes = sizeof(FilmPixel);
    header.width = identity.width, header.height = identity.height;
    header.position = checkpoint.position.at;
    header.halves = std::uint32_t(checkpoint.position.halves.size());
    const ErrorProgress& error = checkpoint.error;
    header.controls = std::uint32_t(error.controls.size());
    header.error_spp = error.spp, header.error = error.last, header.error_power = error.power;
    header.scene = identity.scene, header.settings = identity.settings, header.kernels = identity.kernels;
    header.digest = digest_of_checkpoint_header(header);
    const Digest digest = digest_of_parts(checkpoint);
    NewFile file(path);
    file.write(&header, sizeof header);
    visit_parts(checkpoint, [&](const auto& values) { file.write(values.data(), bytes_of(values)); });
    file.write(digest.data(), digest.size());
    file.commit();
}

Checkpoint read_checkpoint(const std::filesystem::path& path, const RenderIdentity& identity, std::uint32_t spp) {
    CheckpointFile file(path);
    const CheckpointHeader header = file.header();
    if (header.width != identity.width || header.height != identity.height)
        file.refuse("its image has " + size_of(header.width, header.height) + " pixels instead of " +
                        size_of(identity.width, identity.height),
                    "use the same --size");
    if (header.scene != identity.scene)
        file.refuse("it belongs to another scene or camera", "use the scene and the camera for which it was written");
    if (header.settings != identity.settings)
        file.refuse(
            "it was rendered with another seed, depth, sampler or effects, or other use of --adaptive or --no-guide",
            "use the same settings");
    if (header.kernels != identity.kernels)
        file.refuse("it was written by a version of claray with other kernels",
                    "use that version, or render from the start");
    const PassSchedule::Position& at = header.position;
    const bool within = at.pixel != 0 || at.sample != 0;
    if (header.halves == 0 && (at.pixel >= header.width * header.height || (within && at.sample >= at.pass)))
        file.refuse_damaged("its position is outside the image");
    const std::uint64_t most = std::uint64_t(at.done) + (within ? at.pass : 0);
    if (header.halves == 0 && most > spp)
        file.refuse(
            "it has " + std::to_string(most) + " samples per pixel, but only " + std::to_string(spp) + " are requested",
            "use a larger --spp");
    const auto sound = [](double value) { return value >= 0 && std::isfinite(value); };
    if (!(sound(header.error.square) && sound(header.error.deviation) && sound(header.error.fireflies) &&
          std::isfinite(header.error_power)) ||
        (header.halves == 0 && header.error_spp > at.done) || header.controls > most_control_pixels)
        file.refuse_damaged("its error estimate is not a valid number");
    Checkpoint checkpoint{{at, {}}, {header.error, header.error_power, header.error_spp, {}}, {}};
    file.read_rest(header, checkpoint);
    if (!are_before(checkpoint.position.pending, header))
        file.refuse_damaged("its pending samples are outside the image");
    if (!are_sound(checkpoint.error.controls, header)) file.refuse_damaged("its control pixels are outside the image");
    return checkpoint;
}

}  // namespace claray
