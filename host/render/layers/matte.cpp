#include "host/render/layers/matte.hpp"

#include <algorithm>

#include "host/render/renderer_state.hpp"

namespace claray {
namespace {

constexpr const char* file = "render/layers/mask_paths.cl";

KernelRequest kernel_of(const char* name, const StructureFormat& structure) {
    return {file, name, structure.defines()};
}

std::uint32_t pixels_of(const RenderConfig& config) { return config.image_width() * config.image_height(); }

bool catches(const Material& material) { return material.role == MaterialRole::shadow_catcher; }

std::vector<std::uint32_t> roles_of(const Scene& scene) {
    std::vector<std::uint32_t> roles(std::max<std::size_t>(1, scene.materials.size()));
    for (std::size_t i = 0; i < scene.materials.size(); ++i) roles[i] = std::uint32_t(scene.materials[i].role);
    return roles;
}

RenderConfig without_options(RenderConfig config) {
    config.alpha = config.guide = false;
    config.error = config.noise = config.seconds = 0;
    config.compiler.clear();
    return config;
}

/// What is left of the light of a catcher: the least of the three colours. 1 where none was.
float share_left(const glm::vec3& with, const glm::vec3& without) {
    float share = 1.f;
    for (int c = 0; c < 3; ++c)
        if (without[c] > 0.f) share = std::min(share, with[c] / without[c]);
    return share;
}

}  // namespace

Scene scene_of_catchers(const Scene& scene) {
    Scene left = scene;
    const auto stays = [&](const std::vector<std::uint32_t>& materials, std::size_t i) {
        const std::uint32_t number = materials.empty() ? 0 : materials[i];
        if (number >= scene.materials.size()) return false;
        return catches(scene.materials[number]) || scene.materials[number].emission != glm::vec3(0.f);
    };
    for (Mesh& mesh : left.meshes) {
        const std::vector<glm::uvec3> triangles = std::move(mesh.triangles);
        const std::vector<std::uint32_t> materials = std::move(mesh.materials);
        mesh.triangles.clear(), mesh.materials.clear();
        for (std::size_t i = 0; i < triangles.size(); ++i) {
            if (!stays(materials, i)) continue;
            mesh.triangles.push_back(triangles[i]);
            if (!materials.empty()) mesh.materials.push_back(materials[i]);
        }
    }
    std::erase_if(left.primitives, [&](const PrimitiveSet& set) {
        for (std::size_t i = 0; i < primitive_count(set); ++i)
            if (stays(set.materials, i)) return false;
        return true;
    });
    return left;
}

Matte::Matte(const Device& device, const Scene& scene, const RenderConfig& config)
    : device_(device),
      sample_clamp_(config.sample_clamp),
      roles_(device, roles_of(scene)),
      coverage_(device, pixels_of(config)) {
    if (std::none_of(scene.materials.begin(), scene.materials.end(), catches)) return;
    if (config.adaptive)
        throw Error(ErrorKind::usage, "adaptive sampling and shadow catchers exclude each other", "use one of them");
    const auto film = [&] { return Film(device, pixels_of(config), config.sample_clamp); };
    catchers_ = Catchers{Renderer(device, scene_of_catchers(scene), without_options(config)), film(), film(), {}};
}

/// Both kernels are in one program.
KernelSet Matte::programs(const Device& device, const StructureFormat& structure) {
    KernelSet set;
    set.add(device, kernel_of("mask_paths", structure));
    return set;
}

void Matte::mask(const Batch& batch, Wavefront& wavefront) {
    const std::uint32_t paths = batch.pixels * batch.samples;
    weights_.reserve(device_, 3 * std::size_t(paths));
    if (catchers_) catchers_->radiance.reserve(device_, 3 * std::size_t(paths));
    wavefront.trace_camera_rays(batch, weights_);
    load_kernel(device_, kernel_of("mask_paths", wavefront.scene.structure.format()))
        .run({paths, 64}, wavefront.step_of({}, 0, paths), wavefront.scene, wavefront.queues.hits, arg("roles", roles_),
             arg("radiance", wavefront.queues.radiance), arg("weights", weights_),
             arg("caught", catchers_ ? catchers_->radiance : Buffer<float>()));
}

void Matte::hide(const Batch& batch, Wavefront& wavefront) { mask(batch, wavefront); }

void Matte::take(const Batch& batch, const Batch& in_film, Wavefront& wavefront) {
    mask(batch, wavefront);
    const SceneBuffers& scene = wavefront.scene;
    coverage_.accumulate(in_film, weights_, scene.tables, scene.where.listed_pixels);
    if (!catchers_) return;
    catchers_->caught.accumulate(in_film, catchers_->radiance);
    trace_without(batch, in_film, wavefront);
}

/// By the same random numbers, so that catchers that no other surface changes differ by nothing.
void Matte::trace_without(const Batch& batch, const Batch& in_film, const Wavefront& wavefront) {
    Wavefront& other = state_of(catchers_->without).wavefront;
    other.frame.camera = wavefront.frame.camera;
    other.frame.seed = wavefront.frame.seed, other.frame.max_depth = wavefront.frame.max_depth;
    Kernel keep = load_kernel(device_, kernel_of("keep_caught", wavefront.scene.structure.format()));
    const std::uint32_t most = other.queues.capacity, samples = std::min(batch.samples, most);
    for (std::uint32_t pixel = 0; pixel < batch.pixels;) {
        const std::uint32_t pixels = std::min(batch.pixels - pixel, samples < batch.samples ? 1 : most / samples);
        for (std::uint32_t done = 0; done < batch.samples; done += samples) {
            const std::uint32_t now = std::min(samples, batch.samples - done);
            Batch part{batch.first_pixel + pixel, pixels, batch.first_sample + done, now, batch.listed};
            other.trace(part);
            const std::uint32_t first = pixel * batch.samples + done;
            keep.run({pixels * now, 64}, pixels * now, first, arg("weights", weights_),
                     arg("radiance", other.queues.radiance));
            part.first_pixel = in_film.first_pixel + pixel, part.listed = in_film.listed;
            catchers_->empty.accumulate(part, other.queues.radiance);
        }
        pixel += pixels;
    }
}

std::vector<float> Matte::alpha() const {
    const std::vector<glm::vec3> coverage = coverage_.image();
    std::vector<float> alpha;
    for (const glm::vec3& weights : coverage) alpha.push_back(weights.x);
    if (!catchers_) return alpha;
    const std::vector<glm::vec3> with = catchers_->caught.image(), without = catchers_->empty.image();
    for (std::size_t i = 0; i < alpha.size(); ++i)
        alpha[i] = std::min(1.f, alpha[i] + coverage[i].y * (1.f - share_left(with[i], without[i])));
    return alpha;
}

/// Composited over what the catchers show without other surfaces, it gives what they show with them.
void Matte::finish(const ImageSizes& size, std::span<glm::vec3> image) const {
    if (!catchers_) return;
    const std::vector<glm::vec3> with = catchers_->caught.image(size), without = catchers_->empty.image(size);
    for (std::size_t i = 0; i < image.size(); ++i) image[i] += with[i] - share_left(with[i], without[i]) * without[i];
}

void Matte::clear() {
    coverage_.clear();
    if (catchers_) catchers_->caught.clear(), catchers_->empty.clear();
}

void Matte::resize(unsigned width, unsigned height) {
    coverage_ = Film(device_, width * height);
    if (!catchers_) return;
    catchers_->without.resize(width, height);
    catchers_->caught = Film(device_, width * height, sample_clamp_);
    catchers_->empty = Film(device_, width * height, sample_clamp_);
}

void Matte::follow(const Scene& scene, const SceneChanges& changes) {
    SceneChanges of_camera;
    of_camera.camera = changes.camera;
    const bool only_camera =
        !(changes.lights || changes.materials || changes.sky || changes.instances || changes.vertices);
    const bool gets_catchers =
        !catchers_ && changes.materials && std::any_of(scene.materials.begin(), scene.materials.end(), catches);
    if (gets_catchers || (catchers_ && !only_camera))
        throw Error(ErrorKind::usage, "shadow catchers follow no changes of the scene but the camera's",
                    "make a new renderer");
    if (changes.materials) roles_ = Buffer<std::uint32_t>(device_, roles_of(scene));
}

std::uint64_t Matte::bytes() const {
    const std::uint64_t own = buffer_bytes(roles_, coverage_, weights_);
    return catchers_ ? own + buffer_bytes(catchers_->caught, catchers_->empty, catchers_->radiance) +
                           catchers_->without.statistics().device_bytes
                     : own;
}

}  // namespace claray
