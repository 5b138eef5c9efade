// Converged images: the mean of many renders, saved in a file from which later runs continue.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>
#include <optional>

#include "claray/accuracy.hpp"
#include "host/base/file.hpp"
#include "host/base/hash.hpp"

namespace claray {
namespace {

constexpr char magic[16] = "claray ref. 1\n";
constexpr std::chrono::seconds between_saves(5);

/// Of independent renders, by channel.
struct Sums {
    std::vector<double> values, squares;
    std::uint32_t renders = 0;
};

std::vector<glm::vec3> render_once(Renderer& renderer, unsigned spp, std::uint32_t seed) {
    renderer.restart(seed, spp);
    renderer.render();
    return renderer.image();
}

/// A name that differs if the converged image may differ. Renders are reproducible bit for bit, so that a few samples
/// identify scene and settings.
std::string name_of_reference(const Device& device, Renderer& renderer, const RenderConfig& config,
                              const ReferenceOptions& options) {
    const std::vector<glm::vec3> probe = render_once(renderer, 4, options.seed - 1);
    std::string all = device.info().name + '\n' + device.info().driver + '\n' + std::to_string(config.width) + 'x' +
                      std::to_string(config.height) + ' ' + std::to_string(config.max_depth) + ' ' +
                      std::to_string(options.seed) + ' ' + std::to_string(options.render_spp) + '\n';
    all.append(reinterpret_cast<const char*>(probe.data()), probe.size() * sizeof(glm::vec3));
    return "reference-" + hash128(all) + ".bin";
}

std::string bytes_of(const Sums& sums) {
    std::string bytes(magic, sizeof magic);
    bytes.append(reinterpret_cast<const char*>(&sums.renders), sizeof sums.renders);
    for (const std::vector<double>* part : {&sums.values, &sums.squares})
        bytes.append(reinterpret_cast<const char*>(part->data()), part->size() * sizeof(double));
    const Digest digest = digest_of(bytes.data(), bytes.size());
    bytes.append(reinterpret_cast<const char*>(digest.data()), digest.size());
    return bytes;
}

/// Nothing if the file is missing or damaged: then the reference is rendered again.
std::optional<Sums> load(const std::filesystem::path& path, std::size_t values) {
    std::error_code none;
    if (!std::filesystem::exists(path, none)) return std::nullopt;
    const std::string bytes = read_file(path, "");
    const std::size_t body = sizeof magic + sizeof(std::uint32_t) + 2 * values * sizeof(double);
    if (bytes.size() != body + sizeof(Digest) || std::memcmp(bytes.data(), magic, sizeof magic) != 0)
        return std::nullopt;
    const Digest digest = digest_of(bytes.data(), body);
    if (std::memcmp(bytes.data() + body, digest.data(), sizeof digest) != 0) return std::nullopt;
    Sums sums;
    const char* from = bytes.data() + sizeof magic;
    std::memcpy(&sums.renders, from, sizeof sums.renders);
    from += sizeof sums.renders;
    for (std::vector<double>* part : {&sums.values, &sums.squares}) {
        part->resize(values);
        std::memcpy(part->data(), from, values * sizeof(double));
        from += values * sizeof(double);
    }
    return sums;
}

/// The mean, and its standard error from the spread of the renders.
ReferenceImage reference_of(const Sums& sums, unsigned render_spp) {
    ReferenceImage reference;
    const std::size_t values = sums.values.size();
    const double n = sums.renders;
    reference.pixels.resize(values / 3);
    reference.spp = render_spp * sums.renders;
    double variance = 0, mean = 0;
    for (std::size_t i = 0; i < values; ++i) {
        const double value = sums.values[i] / n;
        reference.pixels[i / 3][glm::length_t(i % 3)] = float(value);
        mean += value;
        variance += std::max(sums.squares[i] / n - value * value, 0.0) / (n - 1);
    }
    reference.uncertainty = std::sqrt(variance / double(values)) / std::max(mean / double(values), 1e-30);
    return reference;
}

void refuse_black(const Sums& sums, unsigned render_spp) {
    if (std::any_of(sums.values.begin(), sums.values.end(), [](double value) { return value != 0; })) return;
    throw Error(ErrorKind::user,
                "the image is black after " + std::to_string(render_spp * sums.renders) +
                    " samples per pixel: an error relative to its mean is undefined",
                "add light, or choose studies of rays and trees");
}

void add_render(Sums& sums, Renderer& renderer, const ReferenceOptions& options) {
    const auto image = render_once(renderer, options.render_spp, options.seed + sums.renders);
    for (std::size_t i = 0; i < 3 * image.size(); ++i) {
        const double value = double(image[i / 3][glm::length_t(i % 3)]);
        sums.values[i] += value, sums.squares[i] += value * value;
    }
    ++sums.renders;
}

}  // namespace

ReferenceImage reference_image(const Device& device, const Scene& scene, const RenderConfig& how,
                               const ReferenceOptions& options, const AccuracyProgress& progress) {
    RenderConfig config = how;
    config.spp = std::max(options.render_spp, 4u), config.seconds = config.noise = 0;
    Renderer renderer(device, scene, config);
    const std::size_t values = 3 * std::size_t(config.width) * config.height;
    const std::filesystem::path path =
        options.folder.empty() ? options.folder : options.folder / name_of_reference(device, renderer, config, options);
    Sums sums{std::vector<double>(values), std::vector<double>(values), 0};
    if (!path.empty()) {
        make_folder(options.folder);
        if (std::optional<Sums> kept = load(path, values)) sums = std::move(*kept);
    }
    const unsigned least_renders = std::max(options.least_renders, 2u);
    auto saved = std::chrono::steady_clock::now();
    bool changed = false;
    const auto save = [&] {
        if (!path.empty() && changed) write_file(path, bytes_of(sums));
        saved = std::chrono::steady_clock::now(), changed = false;
    };
    const auto is_enough = [&] {
        const unsigned spp = options.render_spp * sums.renders;
        if (sums.renders < least_renders || spp < options.least_spp) return false;
        return options.uncertainty <= 0 || spp >= options.most_spp ||
               reference_of(sums, options.render_spp).uncertainty <= options.uncertainty;
    };
    try {
        while (!is_enough()) {
            add_render(sums, renderer, options);
            changed = true;
            if (std::chrono::steady_clock::now() - saved > between_saves) save();
            const unsigned spp = options.render_spp * sums.renders;
            const double done =
                std::min(1.0, double(spp) / std::max(options.least_spp, options.render_spp * least_renders));
            if (progress && !progress(done, "reference, " + std::to_string(spp) + " spp") && sums.renders > 1) break;
        }
    } catch (...) {  // by `progress`, too
        save();
        throw;
    }
    save();
    refuse_black(sums, options.render_spp);
    return reference_of(sums, options.render_spp);
}

}  // namespace claray
