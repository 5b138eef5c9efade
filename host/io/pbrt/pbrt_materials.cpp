#include "host/io/pbrt/pbrt_materials.hpp"

#include <algorithm>
#include <cmath>

#include "claray/error.hpp"
#include "host/io/text_file.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

constexpr int most_definitions_deep = 64;  // textures and mixtures of each other

glm::vec3 rgb_of(const std::vector<double>& numbers, const glm::vec3& otherwise) {
    if (numbers.size() >= 3) return {numbers[0], numbers[1], numbers[2]};
    return numbers.empty() ? otherwise : glm::vec3(float(numbers[0]));
}

/// pbrt's coordinates begin at the bottom of an image; those of meshes were turned over when these were made.
void set_mapping(TextureUse& use, const PbrtParameters& p, double squares) {
    const double su = p.number("uscale", 1) / squares, sv = p.number("vscale", 1) / squares;
    const double du = p.number("udelta", 0) / squares, dv = p.number("vdelta", 0) / squares;
    use.scale = {su, sv};
    use.offset = {du, 1 - sv - dv};
}

}  // namespace

void PbrtMaterials::add_texture(const std::string& name, const std::string& of, const std::string& kind,
                                PbrtParameters parameters) {
    textures_[name] = {of != "float", kind, std::move(parameters)};
}

std::size_t PbrtMaterials::add(const std::string& kind, PbrtParameters parameters) {
    materials_.push_back({kind, std::move(parameters)});
    return materials_.size() - 1;
}

void PbrtMaterials::add_named(const std::string& name, PbrtParameters parameters) {
    const std::string kind = parameters.text("type");
    named_[name] = add(kind, std::move(parameters));
}

std::optional<std::size_t> PbrtMaterials::named(const std::string& name) const {
    const auto found = named_.find(name);
    return found == named_.end() ? std::nullopt : std::optional(found->second);
}

const Look& PbrtMaterials::look(std::size_t material) {
    if (!materials_[material].look) {
        const auto& [kind, parameters, made, number, in_work] = materials_[material];
        if (in_work || depth_ >= most_definitions_deep)
            throw Error(ErrorKind::user, parameters.place() + ": mixtures contain each other", "name other materials");
        materials_[material].in_work = true;
        ++depth_;
        Look fresh = make(kind, parameters);
        --depth_;
        materials_[material].look = std::move(fresh);
        materials_[material].in_work = false;
    }
    return *materials_[material].look;
}

std::size_t PbrtMaterials::look_of(std::size_t material, const PbrtParameters& shape) {
    if (shape.find("alpha")) {
        Look with_holes = look(material);
        set_opacity(with_holes, world_.paints(), paint(shape, "alpha", Paint(1.f)));
        return world_.add_look(std::move(with_holes));
    }
    if (!materials_[material].number) {
        const std::size_t number = world_.add_look(look(material));
        materials_[material].number = number;
    }
    return *materials_[material].number;
}

// ---- values

std::vector<SpectrumSample> PbrtMaterials::samples(const PbrtParameter& parameter) {
    std::vector<double> numbers = parameter.numbers;
    if (numbers.empty() && !parameter.texts.empty()) {
        const std::filesystem::path& scene = world_.paints().path();
        const std::filesystem::path file =
            path_in_scene(scene.parent_path(), scene.parent_path(), parameter.texts[0], scene);
        const std::string text = read_text(file, "check the name of the spectrum");
        std::string_view rest = text;
        while (!rest.empty()) {
            const std::size_t end = std::min(rest.find('\n'), rest.size());
            std::string_view line = rest.substr(0, end);
            rest.remove_prefix(std::min(end + 1, rest.size()));
            for (std::string_view word = next_word(line); !word.empty(); word = next_word(line))
                numbers.push_back(number_in(word).value_or(0));
        }
    }
    std::vector<SpectrumSample> result;
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) result.push_back({numbers[i], numbers[i + 1]});
    std::sort(result.begin(), result.end(),
              [](const SpectrumSample& a, const SpectrumSample& b) { return a.wavelength < b.wavelength; });
    return result;
}

glm::vec3 PbrtMaterials::light(const PbrtParameters& parameters, std::string_view name, const glm::vec3& otherwise) {
    const PbrtParameter* found = parameters.find(name);
    if (!found) return otherwise;
    if (found->type == "blackbody") return rgb_of_blackbody(parameters.number(name, 6500));
    if (found->type != "spectrum") return rgb_of(found->numbers, otherwise);
    if (!found->texts.empty() && found->texts[0].starts_with("stdillum-")) {
        world_.warn("the illuminant " + claray::quoted(found->texts[0]) + " is shown as white");
        return glm::vec3(1.f);
    }
    const glm::vec3 color = rgb_of_light(samples(*found));
    const float luminance = luminance_of(color);
    return luminance > 0.f ? glm::max(color / luminance, 0.f) : glm::vec3(0.f);
}

Paint PbrtMaterials::paint(const PbrtParameters& parameters, std::string_view name, const Paint& otherwise) {
    const PbrtParameter* found = parameters.find(name);
    if (!found) return otherwise;
    if (found->type == "texture" && !found->texts.empty()) return texture(found->texts[0]);
    if (found->type == "spectrum") return Paint(glm::max(rgb_of_reflectance(samples(*found)), 0.f));
    return Paint(rgb_of(found->numbers, otherwise.factor));
}

float PbrtMaterials::ior(const PbrtParameters& parameters, const std::string& name) {
    const PbrtParameter* found = parameters.find(name);
    if (!found) return 1.5f;
    if (found->type != "spectrum") return float(parameters.number(name, 1.5));
    if (!found->texts.empty())
        if (const auto known = ior_named(found->texts[0])) return *known;
    return luminance_of(rgb_of_light(samples(*found)));
}

Alphas PbrtMaterials::alphas(const PbrtParameters& parameters, const std::string& prefix) {
    const Paint both = paint(parameters, prefix + "roughness", Paint(0.f));
    Alphas result{paint(parameters, prefix + "uroughness", both), paint(parameters, prefix + "vroughness", both)};
    if (!parameters.flag("remaproughness", true)) return result;
    const auto remap = [](const glm::vec3& x) { return glm::sqrt(glm::max(x, 0.f)); };  // pbrt-v4's RoughnessToAlpha
    result.u = world_.paints().changed(result.u, "remapped", remap);
    result.v = world_.paints().changed(result.v, "remapped", remap);
    return result;
}

// ---- textures

const Paint& PbrtMaterials::texture(const std::string& name) {
    static const Paint grey(0.5f);
    const auto found = textures_.find(name);
    if (found == textures_.end()) {
        world_.warn("the texture " + claray::quoted(name) + " is not defined, and what it would colour is grey");
        return grey;
    }
    TextureDefinition& definition = found->second;
    if (definition.in_work || depth_ >= most_definitions_deep)
        throw Error(ErrorKind::user, definition.parameters.place() + ": textures contain each other",
                    "name other textures");
    if (!definition.paint) {
        definition.in_work = true;
        ++depth_;
        definition.paint = make_texture(definition);
        --depth_;
        definition.in_work = false;
    }
    return *definition.paint;
}

Paint PbrtMaterials::image(const PbrtParameters& p) {
    TextureSettings settings;
    const std::string wrap = p.text("wrap", "repeat"), filter = p.text("filter", "bilinear"),
                      encoding = p.text("encoding", "sRGB");
    if (wrap == "clamp" || wrap == "black") settings.wrap_u = settings.wrap_v = Wrap::clamp;
    settings.filter = filter == "point" ? Filter::nearest : Filter::trilinear;
    if (encoding != "sRGB") settings.eight_bit = TexelFormat::linear8;
    Paint result = world_.paints().image(p.text("filename"), settings);
    if (result.varies()) set_mapping(result.use, p, 1);
    if (encoding.starts_with("gamma")) {
        std::string_view words = encoding;
        (void)next_word(words);
        const auto gamma = float(number_in(next_word(words)).value_or(2.2));
        result = world_.paints().changed(result, encoding,
                                         [gamma](const glm::vec3& c) { return glm::pow(c, glm::vec3(gamma)); });
    }
    const auto scale = float(p.number("scale", 1));
    if (p.flag("invert", false))
        return world_.paints().changed(result, "inverted",
                                       [scale](const glm::vec3& c) { return glm::max(1.f - scale * c, 0.f); });
    result.factor *= scale;
    return result;
}

Paint PbrtMaterials::make_texture(const TextureDefinition& definition) {
    const PbrtParameters& p = definition.parameters;
    if (p.text("mapping", "uv") != "uv")
        world_.warn("the texture mapping " + claray::quoted(p.text("mapping")) +
                    " is not supported: coordinates of shapes are used");
    if (definition.kind == "constant") return paint(p, "value", Paint(1.f));
    if (definition.kind == "imagemap") return image(p);
    if (definition.kind == "scale")
        return world_.paints().product(paint(p, "tex", Paint(1.f)), paint(p, "scale", Paint(1.f)));
    if (definition.kind == "mix")
        return world_.paints().mixed(paint(p, "tex1", Paint(0.f)), paint(p, "tex2", Paint(1.f)),
                                     paint(p, "amount", Paint(0.5f)));
    if (definition.kind == "checkerboard" && p.number("dimension", 2) == 2) {
        Paint board = world_.paints().checkerboard(paint(p, "tex1", Paint(1.f)), paint(p, "tex2", Paint(0.f)));
        if (!board.varies()) return board;
        set_mapping(board.use, p, 2);  // a board has two squares a side; pbrt counts them from the bottom
        board.use.offset.y = 1.f - board.use.offset.y, board.use.scale.y = -board.use.scale.y;
        return board;
    }
    world_.warn("textures " + claray::quoted(definition.kind) +
                " are not supported, and what they would colour is grey");
    return Paint(0.5f);
}

// ---- materials

Look PbrtMaterials::metal(const PbrtParameters& p, const std::string& prefix, const std::string& fallback) {
    const Alphas rough = alphas(p, prefix);
    if (p.find("reflectance")) return metal_look(world_.paints(), paint(p, "reflectance", Paint(0.5f)), rough);
    Conductor conductor = *conductor_named(fallback);
    for (const bool is_eta : {true, false}) {
        const std::string name = prefix + (is_eta ? "eta" : "k");
        const PbrtParameter* found = p.find(name);
        glm::vec3& value = is_eta ? conductor.eta : conductor.k;
        if (!found) continue;
        if (found->type == "texture") {
            value = world_.paints().mean(paint(p, name, Paint(value)));
            world_.warn("textures of a metal's index are shown by their means");
        } else if (found->type != "spectrum") {
            value = rgb_of(found->numbers, value);
        } else if (const auto known = found->texts.empty() ? std::nullopt : conductor_named(found->texts[0])) {
            value = is_eta ? known->eta : known->k;
        } else {
            value = glm::max(rgb_of_light(samples(*found)), 0.f);
        }
    }
    return metal_look(world_.paints(), Paint(schlick_color(conductor)), rough);
}

Look PbrtMaterials::coated_metal(const PbrtParameters& p) {
    Look look = metal(p, "conductor.", "Cu");
    Material& m = look.material;
    m.kind = MaterialKind::principled;
    m.metallic = 1.f, m.clearcoat = 1.f;
    m.clearcoat_roughness = std::sqrt(std::clamp(world_.paints().mean(alphas(p, "interface.").u).x, 0.f, 1.f));
    return look;
}

Look PbrtMaterials::mix(const PbrtParameters& p) {
    const PbrtParameter* names = p.find("materials");
    if (!names || names->texts.size() != 2)
        throw Error(ErrorKind::user, p.place() + ": a mixture needs two materials", "name them in \"materials\"");
    Look parts[2] = {grey_look(), grey_look()};
    for (int i = 0; i < 2; ++i) {
        const std::string& name = names->texts[std::size_t(i)];
        if (const auto found = named(name))
            parts[i] = look(*found);
        else if (name == "interface")
            parts[i].invisible = true;
        else
            world_.warn("the material " + claray::quoted(name) + " is not defined: it is grey");
    }
    return mixed_look(world_.paints(), parts[0], parts[1], paint(p, "amount", Paint(0.5f)));
}

/// Displacement changes normals only; normal maps are those of glTF.
void PbrtMaterials::add_relief(Look& look, const PbrtParameters& p) {
    if (p.find("displacement")) {
        const Paint heights = paint(p, "displacement", Paint(0.f));
        look.material.height_map = heights.use;
        look.material.height_scale = heights.factor.x;
    }
    const std::string normals = p.text("normalmap");
    if (normals.empty()) return;
    TextureSettings settings;
    settings.eight_bit = TexelFormat::linear8;
    look.material.normal_map = world_.paints().image(normals, settings).use;
}

Look PbrtMaterials::make(const std::string& kind, const PbrtParameters& p) {
    Look look = grey_look();
    if (kind == "diffuse") {
        look = diffuse_look(world_.paints(), paint(p, "reflectance", Paint(0.5f)));
    } else if (kind == "coateddiffuse") {
        look = plastic_look(world_.paints(), paint(p, "reflectance", Paint(0.5f)), ior(p, "eta"), alphas(p, ""), true);
    } else if (kind == "conductor") {
        look = metal(p, "", "Cu");
    } else if (kind == "coatedconductor") {
        look = coated_metal(p);
    } else if (kind == "dielectric") {
        look = glass_look(world_.paints(), ior(p, "eta"), alphas(p, ""), Paint(1.f));
    } else if (kind == "thindielectric") {
        look = pane_look(world_.paints(), ior(p, "eta"), Paint(1.f));
    } else if (kind == "mix") {
        return mix(p);
    } else if (kind == "interface" || kind.empty() || kind == "none") {
        look.invisible = true;
    } else if (kind == "diffusetransmission") {
        world_.warn("materials 'diffusetransmission' reflect what they should also transmit");
        const Paint reflected = paint(p, "reflectance", Paint(0.25f)), passed = paint(p, "transmittance", Paint(0.25f));
        look = diffuse_look(world_.paints(),
                            reflected.varies() ? reflected : Paint(reflected.factor + world_.paints().mean(passed)));
    } else {
        world_.warn("materials " + claray::quoted(kind) + " are not supported: they are diffuse");
        look = diffuse_look(world_.paints(), paint(p, "reflectance", Paint(0.5f)));
    }
    add_relief(look, p);
    return look;
}

}  // namespace claray
