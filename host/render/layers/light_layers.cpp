#include "host/render/layers/light_layers.hpp"

#include <algorithm>
#include <cstring>

#include "host/compute/read_back.hpp"

namespace claray {
namespace {

/// Numbers the lights of a kind that have this name, or the one that is called by its number: "light:3".
template <class Named, class Shines>
std::vector<std::size_t> numbers_of(const std::string& name, const char* kind, const std::vector<Named>& all,
                                    const Shines& shines) {
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < all.size(); ++i)
        if (shines(all[i]) && (name == all[i].name || name == kind + (":" + std::to_string(i)))) found.push_back(i);
    return found;
}

bool shines(const Light&) { return true; }
bool shines(const Material& material) {
    return material.emission != glm::vec3(0.f) || material.kind == MaterialKind::unlit;
}

template <class Named>
void add_names(std::string& names, const char* kind, const std::vector<Named>& all) {
    for (std::size_t i = 0; i < all.size(); ++i)
        if (shines(all[i])) names += ", " + (all[i].name.empty() ? kind + (":" + std::to_string(i)) : all[i].name);
}

std::string names_of_lights(const Scene& scene) {
    std::string names = "sky";
    add_names(names, "light", scene.lights), add_names(names, "material", scene.materials);
    return names;
}

[[noreturn]] void refuse(const LightGroup& group, const std::string& what, const std::string& remedy) {
    throw Error(ErrorKind::usage, "light group '" + group.name + "': " + what, remedy);
}

std::vector<std::string> split(const std::string& text, char at) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= text.size(); begin += parts.back().size() + 1)
        parts.push_back(text.substr(begin, text.find(at, begin) - begin));
    return parts;
}

LightGroup group_of(const std::string& text) {
    const std::size_t equals = text.find('=');
    LightGroup group{text.substr(0, equals), {}};
    if (equals == std::string::npos || equals + 1 == text.size())
        refuse(group, "it has no lights", "write NAME=light,light, for example key=lamp,sky");
    if (group.name.empty() || group.name == "rest" || group.name.find_first_of(". ") != std::string::npos)
        refuse(group, "this is no name of a group", "use one without dots and spaces; 'rest' is taken");
    group.lights = split(text.substr(equals + 1), ',');
    return group;
}

/// The table that kernels read; the counts of lights are those of the device.
std::vector<std::uint32_t> table_of(const GroupsOfLights& of, bool lobes, std::size_t groups, const Lights& lights) {
    LayerTable header{};
    header.lobes = lobes ? CLARAY_LOBE_COUNT : 0, header.groups = std::uint32_t(groups), header.of_sky = of.sky;
    std::vector<std::uint32_t> words(sizeof header / sizeof(std::uint32_t));
    header.materials = std::uint32_t(words.size());
    words.insert(words.end(), of.materials.begin(), of.materials.end());
    header.triangles = std::uint32_t(words.size());
    for (const std::uint32_t material : lights.triangle_materials) words.push_back(of.materials[material]);
    header.punctual = std::uint32_t(words.size());
    for (const std::uint32_t light : lights.punctual_sources) words.push_back(of.lights[light]);
    header.words = std::uint32_t(words.size());
    std::memcpy(words.data(), &header, sizeof header);
    return words;
}

}  // namespace

unsigned light_layers_of(const RenderConfig& config) {
    return (config.lobes ? unsigned(CLARAY_LOBE_COUNT) : 0) + unsigned(config.light_groups.size());
}

std::vector<std::string> names_of_light_layers(const RenderConfig& config) {
    std::vector<std::string> names;
    if (config.lobes) {
#define CLARAY_LAYER(name, NAME, meaning) names.emplace_back("lobe_" #name);
        CLARAY_LOBES(CLARAY_LAYER)
#undef CLARAY_LAYER
        names.emplace_back("lobe_rest");
    }
    for (const LightGroup& group : groups_of(config.light_groups)) names.push_back("light_" + group.name);
    if (!config.light_groups.empty()) names.emplace_back("light_rest");
    return names;
}

std::vector<LightGroup> groups_of(const std::vector<std::string>& texts) {
    std::vector<LightGroup> groups;
    for (const std::string& text : texts) {
        const LightGroup group = group_of(text);
        if (std::any_of(groups.begin(), groups.end(), [&](auto& other) { return other.name == group.name; }))
            refuse(group, "the name is given twice", "list all lights of a group together");
        groups.push_back(group);
    }
    return groups;
}

GroupsOfLights groups_of_lights(const Scene& scene, const std::vector<LightGroup>& groups) {
    GroupsOfLights of{std::vector<std::uint32_t>(scene.lights.size()),
                      std::vector<std::uint32_t>(scene.materials.size())};
    for (std::size_t i = 0; i < groups.size(); ++i)
        for (const std::string& name : groups[i].lights) {
            const auto put = [&](std::uint32_t& group) {
                if (group != 0) refuse(groups[i], "'" + name + "' is in a group already", "list each light once");
                group = std::uint32_t(i + 1);
            };
            const auto shining = [](const auto& one) { return shines(one); };
            const auto lights = numbers_of(name, "light", scene.lights, shining),
                       materials = numbers_of(name, "material", scene.materials, shining);
            if (name == "sky") put(of.sky);
            for (const std::size_t light : lights) put(of.lights[light]);
            for (const std::size_t material : materials) put(of.materials[material]);
            if (name != "sky" && lights.empty() && materials.empty())
                refuse(groups[i], "there is no light '" + name + "'", "there are: " + names_of_lights(scene));
        }
    return of;
}

LightLayers::LightLayers(const Scene& scene, const RenderConfig& config, Wavefront& wavefront)
    : lobes_(config.lobes),
      groups_(groups_of(config.light_groups)),
      sample_clamp_(config.sample_clamp),
      accumulate_(load_kernel(wavefront.scene.structure.device(), kernel_of_layers())) {
    follow(scene, wavefront);
    sums_ = Buffer<ColorSum>(wavefront.scene.structure.device(), 1);
    resize(config.image_width() * config.image_height());
}

void LightLayers::follow(const Scene& scene, Wavefront& wavefront) {
    const GroupsOfLights of = groups_of_lights(scene, groups_);
    wavefront.queues.split_light(table_of(of, lobes_, groups_.size(), wavefront.scene.lights_on_host()));
}

void LightLayers::accumulate(const Batch& batch, const Wavefront& wavefront, const Buffer<std::uint32_t>& tables,
                             std::uint32_t listed) {
    accumulate_.run({batch.pixels, 64}, batch, arg("tables", tables), listed, sample_clamp_,
                    arg("radiance", wavefront.queues.radiance), wavefront.queues.room(), pixels_, sums_);
}

void LightLayers::clear() { sums_.fill(0); }

void LightLayers::resize(std::uint32_t pixels) {
    pixels_ = pixels;
    const std::size_t layers = (lobes_ ? std::size_t(CLARAY_LOBE_COUNT) : 0) + groups_.size();
    sums_ = Buffer<ColorSum>(sums_.device(), layers * pixels);
    clear();
}

/// The rest of the lobes is what rounding loses; that of the groups is the light of all other lights, too.
std::vector<LightLayer> LightLayers::read(const std::vector<glm::vec3>& image,
                                          const std::vector<FilmPixel>& sums) const {
    const std::vector<ColorSum> all = read_back(sums_);
    std::vector<LightLayer> layers;
    std::size_t next = 0;
    const auto add = [&](const std::string& name, std::vector<glm::dvec3>& left) {
        const std::size_t first = pixels_ * next++;
        LightLayer& layer = layers.emplace_back(LightLayer{name, std::vector<glm::vec3>(pixels_)});
        for (std::size_t i = 0; i < pixels_; ++i) {
            if (sums[i].count == 0) continue;
            const ColorSum& sum = all[first + i];
            const glm::dvec3 total = glm::dvec3(sum.r, sum.g, sum.b) + glm::dvec3(sum.lost_r, sum.lost_g, sum.lost_b);
            layer.pixels[i] = glm::vec3(total / double(sums[i].count));
            left[i] -= glm::dvec3(layer.pixels[i]);
        }
    };
    const auto add_rest = [&](const char* name, const std::vector<glm::dvec3>& left) {
        layers.push_back({name, {left.begin(), left.end()}});
    };
    if (lobes_) {
        std::vector<glm::dvec3> left(image.begin(), image.end());
#define CLARAY_LAYER(name, NAME, meaning) add("lobe_" #name, left);
        CLARAY_LOBES(CLARAY_LAYER)
#undef CLARAY_LAYER
        add_rest("lobe_rest", left);
    }
    if (groups_.empty()) return layers;
    std::vector<glm::dvec3> left(image.begin(), image.end());
    for (const LightGroup& group : groups_) add("light_" + group.name, left);
    add_rest("light_rest", left);
    return layers;
}

}  // namespace claray
