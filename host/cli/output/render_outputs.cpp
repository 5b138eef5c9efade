#include "host/cli/output/render_outputs.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "claray/cryptomatte.hpp"
#include "claray/program.hpp"
#include "host/base/format.hpp"
#include "host/cli/options/render_targets.hpp"
#include "host/cli/output/brightness.hpp"
#include "host/cli/output/messages.hpp"
#include "host/cli/output/table.hpp"
#include "host/cli/picture/alpha.hpp"
#include "host/compute/memory.hpp"
#include "host/render/layers/light_layers.hpp"
#include "host/view/false_colors.hpp"

namespace claray::cli {
namespace {

template <class Vector>
std::vector<float> components_of(const std::vector<Vector>& values) {
    return {&values[0].x, &values[0].x + Vector::length() * values.size()};
}

ImageLayer layer_of(const AovRow& row, const std::vector<float>& pixels) { return {row.name, row.letters, pixels}; }
template <class Vector>
ImageLayer layer_of(const AovRow& row, const std::vector<Vector>& pixels) {
    return {row.name, row.letters, components_of(pixels)};
}
ImageLayer layer_of(const AovRow& row, const std::vector<std::uint32_t>& pixels) {
    return {row.name, row.letters, {}, pixels};
}

void write_raw(const std::filesystem::path& path, unsigned width, unsigned height,
               const std::vector<glm::vec3>& pixels) {
    write_image(path, {width, height, pixels});
}
/// A PFM has one channel or three.
void write_raw(const std::filesystem::path& path, unsigned width, unsigned height,
               const std::vector<glm::vec2>& pixels) {
    std::vector<glm::vec3> colors;
    for (const glm::vec2& pixel : pixels) colors.emplace_back(pixel, 0.f);
    write_raw(path, width, height, colors);
}
template <class Scalar>
void write_raw(const std::filesystem::path& path, unsigned width, unsigned height, const std::vector<Scalar>& pixels) {
    write_pfm(path, width, height, {pixels.begin(), pixels.end()});
}

void write_aov(const std::string& name, const Aovs& aovs, const RenderOptions& options) {
    const unsigned width = options.config.image_width(), height = options.config.image_height();
    const auto [picture, raw] = aov_paths(options.output, name);
    write_image(picture, view::picture_of(aovs, name, width, height), 0.f, ToneMap::none);
    for_each_aov(aovs, [&, &raw = raw](const AovRow& row, const auto& pixels) {
        if (name == row.name) write_raw(raw, width, height, pixels);
    });
}

std::vector<LightLayer> light_layers_in(const Renderer& renderer, const RenderOptions& options) {
    return light_layers_of(options.config) > 0 ? renderer.light_layers() : std::vector<LightLayer>();
}

void write_light_layer(const LightLayer& layer, const RenderOptions& options) {
    const Image image{options.config.image_width(), options.config.image_height(), layer.pixels};
    const auto [picture, raw] = aov_paths(options.output, layer.name);
    write_image(picture, image, options.exposure.value_or(0.f), options.tone_map);
    write_image(raw, image);
}

/// The image and its AOVs; layers and channels have the names that Blender and Nuke show.
void write_layers(const std::vector<glm::vec3>& pixels, const Renderer& renderer, const RenderOptions& options) {
    const Aovs aovs = renderer.aovs();
    const Picture picture = picture_of(pixels, &renderer, options);
    std::vector<ImageLayer> layers = {colors_of(picture, options)};
    ImageAttributes attributes;
    const auto append = [](auto& to, const auto& more) { to.insert(to.end(), more.begin(), more.end()); };
    for (const std::string& name : options.aovs) {
        if (const MatteRow* row = matte_named(name)) {
            const Cryptomatte matte = cryptomatte(renderer, row->kind);
            append(layers, layers_of(matte)), append(attributes, attributes_of(matte));
        }
        for_each_aov(aovs, [&](const AovRow& row, const auto& values) {
            if (name == row.name) layers.push_back(layer_of(row, values));
        });
    }
    for (const LightLayer& layer : light_layers_in(renderer, options))
        layers.push_back({layer.name, "RGB", components_of(layer.pixels)});
    write_exr(named_file(options.output), picture.width, picture.height, layers, attributes);
}

std::vector<glm::vec3> positions_of(const GBuffer& buffer) {
    std::vector<glm::vec3> positions(buffer.pixels.size());
    for (std::size_t i = 0; i < positions.size(); ++i)
        if (buffer.pixels[i].depth != 0.f) positions[i] = position_of(buffer, i);
    return positions;
}

void write_error(const std::vector<float>& widths, const RenderOptions& options) {
    const auto [picture, raw] = aov_paths(options.output, "error");
    write_image(picture, false_color(options.config.image_width(), options.config.image_height(), widths), 0.f,
                ToneMap::none);
    write_pfm(raw, options.config.image_width(), options.config.image_height(), widths);
}

void write_voxels(const std::vector<glm::vec3>& albedo, const RenderOptions& options) {
    const Image image{options.config.width, options.config.height, albedo};
    const auto [picture, raw] = aov_paths(options.output, "voxels");
    write_image(picture, image, 0.f, ToneMap::none);
    write_image(raw, image);
}

void write_gbuffer(const GBuffer& buffer, const RenderOptions& options) {
    std::vector<glm::vec3> albedo, normals;
    std::vector<std::uint32_t> materials;
    std::vector<float> depth;
    for (std::size_t i = 0; i < buffer.pixels.size(); ++i) {
        const GBufferPixel& p = buffer.pixels[i];
        const auto byte = [&](unsigned shift) { return std::uint8_t(p.albedo_material >> shift); };
        albedo.emplace_back(linear_from_srgb(byte(0)), linear_from_srgb(byte(8)), linear_from_srgb(byte(16)));
        materials.push_back(p.normal == CLARAY_NO_SURFACE ? CLARAY_MISS : byte(24));
        normals.push_back(normal_of(buffer, i)), depth.push_back(p.depth);
    }
    const unsigned width = buffer.width, height = buffer.height;
    const Image views[] = {{width, height, albedo},
                           identifier_color(width, height, materials),
                           {width, height, view::direction_colors(normals)},
                           false_color(width, height, depth),
                           {width, height, view::place_colors(positions_of(buffer))}};
    for (std::size_t i = 0; i < std::size(views); ++i)
        write_image(aov_paths(options.output, gbuffer_views[i]).first, views[i], 0.f, ToneMap::none);
    write_file(aov_paths(options.output, "gbuffer").second,
               {reinterpret_cast<const char*>(buffer.pixels.data()), buffer.pixels.size() * sizeof(GBufferPixel)});
}

void print_rays(const char* name, const RayCount& count) {
    if (count.milliseconds == 0) {
        std::printf("%-13s %.3f M\n", name, double(count.rays) * 1e-6);
        return;
    }
    std::printf("%-13s %.3f M, %.1f ms, %.2f Mrays/s\n", name, double(count.rays) * 1e-6, count.milliseconds,
                count.mrays_per_second());
}

nlohmann::ordered_json as_json(const RayCount& count) {
    return {{"rays", count.rays}, {"milliseconds", count.milliseconds}, {"mrays_per_second", count.mrays_per_second()}};
}

nlohmann::ordered_json as_json(EffectSet effects) {
    nlohmann::ordered_json names = nlohmann::ordered_json::array();
    for (const Effect effect : all_effects())
        if (effects.has(effect)) names.push_back(name_of(effect));
    return names;
}

void print_overrides(const EffectOverrides& overrides) {
    if (!overrides.any()) return;
    std::printf("effects are overridden: compiled in: %s; removed from the scene: %s\n",
                to_string(overrides.add).c_str(), to_string(overrides.remove).c_str());
}

const char* name_of(KernelStart start) {
    switch (start) {
        case KernelStart::generic: return "generic";
        case KernelStart::quick: return "quick";
        default: return "own";
    }
}

void print_start(const RenderStatistics& s) {
    std::printf("first pixel   %.2f s (processor time %.2f s), by %s kernels", s.first_pixel_seconds,
                s.first_pixel_processor_seconds, s.start == KernelStart::own ? "the scene's own" : name_of(s.start));
    if (s.start != KernelStart::own && s.own_kernels) std::printf("; its own from sample %u on", s.own_kernels_from);
    std::printf("\n");
}

void print_statistics(const Device& device, const RenderStatistics& s, double seconds) {
    const CompileStatistics compile = compile_statistics();
    std::printf("device        %s\n", device.info().name.c_str());
    std::printf("kernels       %u compiled, %u from the cache, %.0f ms\n", compile.compiled, compile.from_cache,
                compile.milliseconds);
    print_start(s);
    std::printf("build         %.2f ms, %u triangles (%u culled), height %u, SAH cost %.1f, %.1f MB\n",
                s.build_milliseconds, s.bvh.triangles, s.bvh.culled, s.bvh.height, s.bvh.sah_cost,
                double(s.bvh.bytes) * 1e-6);
    if (s.primitives > 0) std::printf("primitives    %u, in trees of their own\n", s.primitives);
    std::printf("effects       %s\n", to_string(s.effects).c_str());
    print_rays("camera rays", s.camera);
    print_rays("bounce rays", s.bounce);
    print_rays("shadow rays", s.shadow);
    if (s.in_paths.rays != 0) print_rays("whole paths", s.in_paths);
    std::printf("longest       %.1f ms, %s\n", s.longest_milliseconds, s.longest_command.c_str());
    std::printf("measuring     noise and error: %.1f ms, %.2f %% of the render\n", 1e3 * s.measuring_seconds,
                seconds > 0 ? 100 * s.measuring_seconds / seconds : 0.0);
    std::printf("memory        %s on the device, at most %s\n", size_text(s.device_bytes).c_str(),
                size_text(s.most_device_bytes).c_str());
    if (s.parts > 1)
        std::printf("parts         %u, %.1f MB copied to the device as they took turns\n", s.parts,
                    double(s.bytes_paged) * 1e-6);
}

constexpr double least_cut_off_to_tell = 5e-4;

void tell_cut_off(const Renderer& renderer, unsigned max_depth) {
    const double share = renderer.cut_off();
    if (share >= least_cut_off_to_tell)
        std::printf("about %.2g %% of the light is missing: paths end after %u surfaces (--max-depth)\n", 100 * share,
                    max_depth);
}

/// The quiet ask for it by --stats.
bool tells_plan(const RenderOptions& options) { return options.stats || !options.quiet; }

}  // namespace

void choose_exposure(const std::vector<glm::vec3>& pixels, const Renderer* renderer, RenderOptions& options) {
    if (options.exposure || !is_shaped(options)) return;
    SurfaceBrightness surfaces(pixels, {}, options.tone_map);
    const bool asks = options.auto_exposure || surfaces.is_doubtful();
    if (asks && renderer != nullptr) {
        const Aovs aovs = renderer->aovs();
        surfaces = SurfaceBrightness(pixels, aovs.depth, options.tone_map, aovs.albedo);
    }
    const char* const fault = asks ? surfaces.fault() : nullptr;
    options.exposure = options.auto_exposure || fault ? surfaces.exposure() : 0.f;
    if (fault && !options.auto_exposure)
        print_warning(
            printed("the surfaces would be mostly %s: their exposure is %+.1f stops; choose another with "
                    "--exposure, 0 for none",
                    fault, double(*options.exposure)));
}

void write_picture(const std::vector<glm::vec3>& pixels, const RenderOptions& options, const Renderer* renderer) {
    const bool has_layers = std::any_of(options.aovs.begin(), options.aovs.end(),
                                        [&](const std::string& name) { return is_layer(options, name); }) ||
                            (light_layers_of(options.config) > 0 && format_of(options) == ImageFormat::exr);
    if (renderer != nullptr && has_layers)
        write_layers(pixels, *renderer, options);
    else if (const Picture picture = picture_of(pixels, renderer, options); !picture.alpha.empty())
        write_with_alpha(picture, options);
    else
        write_image(named_file(options.output), {picture.width, picture.height, picture.pixels},
                    options.exposure.value_or(0.f), options.tone_map, encoding_of(options));
    const std::optional<float> exposure =
        is_shaped(options) ? std::optional(options.exposure.value_or(0.f)) : std::nullopt;
    if (const auto line = brightness_warning(pixels, exposure)) print_warning(*line);
}

void check_denoiser(DenoiserKind kind) {
    if (kind == DenoiserKind::oidn) require_oidn();
}

Denoised denoise(Renderer& renderer, const RenderOptions& options) {
    if (!options.denoiser) return {};
    const DenoiserKind kind = picked_denoiser(*options.denoiser);
    const auto begin = std::chrono::steady_clock::now();
    Denoised denoised{{}, kind == DenoiserKind::oidn ? "Open Image Denoise" : "claray"};
    if (!options.quiet) std::fprintf(stderr, "denoising by %s\n", denoised.by);
    denoised.image = renderer.denoised(kind);
    denoised.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    if (options.config.error > 0) denoised.error = renderer.error_of(denoised.image);
    return denoised;
}

void write_aovs(Renderer& renderer, const RenderOptions& options, Writes& writes) {
    if (format_of(options) != ImageFormat::exr)
        for (const LightLayer& layer : light_layers_in(renderer, options))
            writes.attempt([&] { write_light_layer(layer, options); });
    std::optional<Aovs> aovs;
    for (const std::string& name : options.aovs) {
        if (name == "lobes") continue;
        if (name == "error") {
            writes.attempt([&] { write_error(renderer.error_map(), options); });
            continue;
        }
        if (name == "gbuffer") {
            writes.attempt([&] { write_gbuffer(renderer.gbuffer(), options); });
            continue;
        }
        if (name == "voxels") {
            writes.attempt([&] { write_voxels(renderer.voxels(), options); });
            continue;
        }
        if (is_layer(options, name)) continue;
        if (!aovs) aovs = renderer.aovs();
        writes.attempt([&] { write_aov(name, *aovs, options); });
    }
}

namespace {

void print_shares(const std::vector<DeviceShare>& shares) {
    double all = 0;
    for (const DeviceShare& share : shares) all += double(share.samples);
    for (const DeviceShare& share : shares)
        std::printf("  %s: %.1f %% of the samples, %.4g million per second%s\n", share.name.c_str(),
                    100 * double(share.samples) / std::max(all, 1.), 1e-6 * share.samples_per_second,
                    share.failure.empty() ? "" : "; dropped");
}

nlohmann::ordered_json as_json(const std::vector<DeviceShare>& shares) {
    auto devices = nlohmann::ordered_json::array();
    for (const DeviceShare& share : shares)
        devices.push_back({{"name", share.name},
                           {"samples", share.samples},
                           {"samples_per_second", share.samples_per_second},
                           {"failure", share.failure}});
    return devices;
}

}  // namespace

void tell_of_idle_options(const Renderer& renderer, const RenderOptions& options) {
    const RenderStatistics s = renderer.statistics();
    if (options.config.adaptive && !s.adapted)
        print_warning(
            "--adaptive changed nothing: all pixels have the same number of samples, because rounds begin after "
            "16 samples per pixel and only where the error differs between tiles");
    if (options.asks_for_guiding && !s.guided) {
        const std::string why = renderer.why_unguided();
        print_warning("--guide changed nothing: " +
                      (why.empty() ? "no path was guided, because it needs a CPU, more than 8 samples per pixel, "
                                     "16,384 pixels and light that guided paths find with less noise"
                                   : why));
    }
}

void print_as_text(const Device& device, const Renderer& renderer, const RenderOptions& options, const Outcome& outcome,
                   const TargetPlan* plan, const Denoised& denoised, const std::vector<DeviceShare>& shares) {
    const RenderProgress& p = outcome.progress;
    if (plan && tells_plan(options)) print_picks(plan->picks);
    print_overrides(options.config.effects);
    if (options.stats) print_statistics(device, renderer.statistics(), p.seconds);
    std::printf("%s: %ux%u, %u spp in %.2f s", options.output.c_str(), options.config.image_width(),
                options.config.image_height(), p.spp, p.seconds);
    if (p.noise > 0) std::printf(", noise %.2f %%", 100 * p.noise);
    if (p.error > 0) std::printf(", error %.2f %%", 100 * p.error);
    std::printf("%s\n", outcome.interrupted ? ", interrupted" : "");
    print_shares(shares);
    if (*denoised.by) std::printf("denoised by %s in %.2f s\n", denoised.by, denoised.seconds);
    if (denoised.error > 0) std::printf("error of the denoised image: about %.3g\n", denoised.error);
    if (outcome.approximation_error > 0)
        std::printf("error with the approximations: about %.3g\n", outcome.approximation_error);
    tell_cut_off(renderer, options.config.max_depth);
    if (const std::string why = renderer.why_unguided(); !options.asks_for_guiding && !why.empty())
        std::printf("%s\n", why.c_str());
    if (plan && tells_plan(options)) {
        const char* verdict = outcome.interrupted ? "stopped" : is_kept(*plan, p) ? "reached" : "missed";
        std::printf("%s: %s\n", verdict, account_of(*plan, p).c_str());
    }
    if (p.dropped_samples > 0)
        print_warning(std::to_string(p.dropped_samples) + " samples were not finite and are left out");
}

void print_as_json(const Device& device, const Renderer& renderer, const RenderOptions& options, const Outcome& outcome,
                   const TargetPlan* plan, const Denoised& denoised, const std::vector<DeviceShare>& shares) {
    const RenderStatistics s = renderer.statistics();
    const CompileStatistics compile = compile_statistics();
    nlohmann::ordered_json report = {
        {"output", options.output.string()},
        {"scene", options.scene},
        {"device", device.info().name},
        {"width", options.config.image_width()},
        {"height", options.config.image_height()},
        {"spp", outcome.progress.spp},
        {"seconds", outcome.progress.seconds},
        {"noise", outcome.progress.noise},
        {"error", outcome.progress.error},
        {"error_bound", outcome.progress.error_bound},
        {"error_of_fireflies", outcome.progress.error_of_fireflies},
        {"approximation_error", outcome.approximation_error},
        {"cut_off", renderer.cut_off()},
        {"measuring_seconds", s.measuring_seconds},
        {"interrupted", outcome.interrupted},
        {"exposure", options.exposure.value_or(0.f)},
        {"adapted", s.adapted},
        {"guided", s.guided},
        {"dropped_samples", s.dropped_samples},
        {"denoised", {{"by", denoised.by}, {"seconds", denoised.seconds}, {"error", denoised.error}}},
        {"kernels",
         {{"compiled", compile.compiled},
          {"from_cache", compile.from_cache},
          {"milliseconds", compile.milliseconds},
          {"start", name_of(s.start)},
          {"own_kernels", s.own_kernels},
          {"own_kernels_from", s.own_kernels_from}}},
        {"first_pixel_seconds", s.first_pixel_seconds},
        {"first_pixel_processor_seconds", s.first_pixel_processor_seconds},
        {"build",
         {{"milliseconds", s.build_milliseconds},
          {"triangles", s.bvh.triangles},
          {"primitives", s.primitives},
          {"culled", s.bvh.culled},
          {"height", s.bvh.height},
          {"sah_cost", s.bvh.sah_cost},
          {"bytes", s.bvh.bytes}}},
        {"effects", as_json(s.effects)},
        {"effect_overrides",
         {{"add", as_json(options.config.effects.add)}, {"remove", as_json(options.config.effects.remove)}}},
        {"rays",
         {{"camera", as_json(s.camera)},
          {"bounce", as_json(s.bounce)},
          {"shadow", as_json(s.shadow)},
          {"in_paths", as_json(s.in_paths)}}},
        {"longest_command", {{"name", s.longest_command}, {"milliseconds", s.longest_milliseconds}}},
        {"device_bytes", s.device_bytes},
        {"most_device_bytes", s.most_device_bytes}};
    if (plan)
        report["target"] = {{"error", plan->config.error},
                            {"seconds", plan->config.seconds},
                            {"promised_seconds", plan->promised_seconds},
                            {"picks", plan->picks},
                            {"kept", !outcome.interrupted && is_kept(*plan, outcome.progress)},
                            {"reached", account_of(*plan, outcome.progress)}};
    if (!shares.empty()) report["devices"] = as_json(shares);
    options.animation ? print_json_line(report) : print_json(report);
}

}  // namespace claray::cli
