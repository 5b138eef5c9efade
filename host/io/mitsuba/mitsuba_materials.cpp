// BSDFs, textures and spectra of Mitsuba 3, with its defaults.
#include <algorithm>
#include <cmath>

#include "host/io/mitsuba/mitsuba_scene.hpp"
#include "host/io/text_file.hpp"
#include "host/io/words.hpp"

namespace claray {
namespace {

constexpr int most_bsdfs_deep = 32;  // BSDFs within each other

bool is_one_of(std::string_view word, std::initializer_list<std::string_view> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
}

/// A 3x3 or 4x4 matrix of coordinates as KHR_texture_transform's scale, rotation and offset; a shear is lost.
void set_coordinates(TextureUse& use, const MitsubaNode& texture) {
    const MitsubaNode* property = texture.property("to_uv");
    if (!property) return;
    const glm::dmat4 m = texture.transform("to_uv");
    const bool is_3x3 = property->children.size() == 1 && property->children[0].tag == "matrix" &&
                        numbers_in(property->children[0].value("value"), *property).size() == 9;
    use.offset = is_3x3 ? glm::vec2(m[2]) : glm::vec2(m[3]);
    use.rotation = float(std::atan2(-m[0][1], m[0][0]));
    const double cosine = std::cos(double(use.rotation)), sine = std::sin(double(use.rotation));
    use.scale = {float(std::hypot(m[0][0], m[0][1])), float(m[1][1] * cosine + m[1][0] * sine)};
}

/// "#rrggbb", of sRGB.
std::optional<glm::vec3> hex_color(const std::string& text) {
    if (text.size() != 7 || text[0] != '#') return {};
    glm::vec3 color;
    for (int k = 0; k < 3; ++k) {
        const std::string digits = text.substr(std::size_t(1 + 2 * k), 2);
        if (digits.find_first_not_of("0123456789abcdefABCDEF") != std::string::npos) return {};
        const float s = float(std::stoi(digits, nullptr, 16)) / 255;
        color[k] = s <= 0.04045f ? s / 12.92f : std::pow((s + 0.055f) / 1.055f, 2.4f);
    }
    return color;
}

std::vector<SpectrumSample> samples_of(const std::string& text, const MitsubaNode& node) {
    std::string spaced = text;
    std::replace(spaced.begin(), spaced.end(), ':', ' ');
    const std::vector<double> numbers = numbers_in(spaced, node);
    std::vector<SpectrumSample> samples;
    for (std::size_t i = 0; i + 1 < numbers.size(); i += 2) samples.push_back({numbers[i], numbers[i + 1]});
    std::sort(samples.begin(), samples.end(),
              [](const SpectrumSample& a, const SpectrumSample& b) { return a.wavelength < b.wavelength; });
    return samples;
}

/// The lines of a .spd file; # begins a comment.
std::string without_comments(const std::string& text) {
    std::string kept;
    for (std::size_t i = 0; i < text.size();) {
        const std::size_t end = std::min(text.find('\n', i), text.size()), comment = std::min(text.find('#', i), end);
        kept += text.substr(i, comment - i) + ' ';
        i = end + 1;
    }
    return kept;
}

}  // namespace

MitsubaMaterials::MitsubaMaterials(const MitsubaNode& scene, World& world) : world_(world) { index(scene); }

void MitsubaMaterials::index(const MitsubaNode& node) {
    if (!node.id.empty() && node.tag != "ref") by_id_.try_emplace(node.id, &node);
    for (const MitsubaNode& each : node.children) index(each);
    if (node.tag == "alias")
        if (const auto found = by_id_.find(node.id); found != by_id_.end())
            by_id_.try_emplace(node.value("as"), found->second);
}

const MitsubaNode* MitsubaMaterials::resolved(const MitsubaNode& node) const {
    if (node.tag != "ref") return &node;
    const auto found = by_id_.find(node.id);
    return found == by_id_.end() ? nullptr : found->second;
}

const MitsubaNode* MitsubaMaterials::child(const MitsubaNode& node, std::string_view tag) const {
    for (const MitsubaNode& each : node.children) {
        const MitsubaNode* object = resolved(each);
        if (!object) world_.warn("the object " + claray::quoted(each.id) + " is not defined, and is left out");
        if (object && object->tag == tag) return object;
    }
    return nullptr;
}

std::size_t MitsubaMaterials::look_of(const MitsubaNode* bsdf) {
    const auto [found, is_new] = looks_.try_emplace(bsdf, 0);
    if (!is_new) return found->second;
    Look look;
    if (bsdf) {
        look = make(*bsdf, 0);
    } else {
        look = diffuse_look(world_.paints(), Paint(0.5f));
        look.both_sides = false;
    }
    look.material.name = bsdf ? bsdf->id : "default";
    return looks_[bsdf] = world_.add_look(std::move(look));
}

// ---- values

Paint MitsubaMaterials::light(const MitsubaNode& emitter, std::string_view name, float otherwise) {
    const MitsubaNode* found = emitter.property(name);
    return found ? value_of(*found, true, false) : Paint(otherwise);
}

Paint MitsubaMaterials::paint(const MitsubaNode& owner, std::string_view name, const Paint& otherwise) {
    const MitsubaNode* found = owner.property(name);
    return found ? value_of(*found, false, is_one_of(name, {"eta", "k"})) : otherwise;
}

Paint MitsubaMaterials::value_of(const MitsubaNode& node, bool is_light, bool is_index) {
    const MitsubaNode* object = resolved(node);
    if (!object) {
        world_.warn("the object " + claray::quoted(node.id) + " is not defined, and what it would colour is grey");
        return Paint(0.5f);
    }
    if (object->tag == "texture") return texture(*object);
    if (object->tag == "spectrum" || object->tag == "blackbody") return spectrum(*object, is_light, is_index);
    const std::string text = object->value("value");
    if (const auto color = hex_color(text)) return Paint(*color);
    const std::vector<double> all = numbers_in(text, *object);
    if (all.size() == 1) return Paint(float(all[0]));
    if (all.size() != 3) object->refuse("a colour needs three numbers", "write \"r, g, b\"");
    glm::vec3 color(all[0], all[1], all[2]);
    if (object->tag == "srgb")
        for (int k = 0; k < 3; ++k)
            color[k] = color[k] <= 0.04045f ? color[k] / 12.92f : std::pow((color[k] + 0.055f) / 1.055f, 2.4f);
    return Paint(color);
}

Paint MitsubaMaterials::spectrum(const MitsubaNode& node, bool is_light, bool is_index) {
    if (node.type == "blackbody" || node.tag == "blackbody") {
        const double kelvin = node.number("temperature", 6500);
        world_.warn("black bodies have a luminance of 1, which Mitsuba's RGB modes do not have at all");
        return Paint(kelvin > 0 ? rgb_of_blackbody(kelvin) : glm::vec3(0.f));
    }
    std::string text = node.value("value");
    if (const std::string file = node.value("filename"); !file.empty()) {
        const std::filesystem::path& scene = world_.paints().path();
        text = without_comments(read_text(path_in_scene(scene.parent_path(), scene.parent_path(), file, scene),
                                          "check the name of the spectrum"));
    } else if (text.find(':') == std::string::npos) {
        const std::vector<double> all = numbers_in(text, node);
        if (all.size() != 1 && all.size() != 3) return Paint(0.5f);
        if (all.size() == 3) return Paint(glm::vec3(all[0], all[1], all[2]));
        constexpr SpectrumSample equal_energy[] = {{300, 1}, {900, 1}};
        return Paint(float(all[0]) * (is_light ? rgb_of_light(equal_energy) : glm::vec3(1.f)));
    }
    const std::vector<SpectrumSample> samples = samples_of(text, node);
    return Paint(glm::max(is_light || is_index ? rgb_of_light(samples) : rgb_of_reflectance(samples), 0.f));
}

Paint MitsubaMaterials::texture(const MitsubaNode& node) {
    Paint result(0.5f);
    if (node.type == "bitmap") {
        TextureSettings settings;
        const std::string wrap = node.text("wrap_mode", "repeat"), filter = node.text("filter_type", "bilinear");
        if (node.flag("raw", false)) settings.eight_bit = TexelFormat::linear8;
        settings.wrap_u = settings.wrap_v = wrap == "mirror"  ? Wrap::mirror
                                            : wrap == "clamp" ? Wrap::clamp
                                                              : Wrap::repeat;
        settings.filter = filter == "nearest" ? Filter::nearest : Filter::trilinear;
        result = world_.paints().image(node.text("filename"), settings);
    } else if (node.type == "checkerboard") {
        result = world_.paints().checkerboard(paint(node, "color0", Paint(0.4f)), paint(node, "color1", Paint(0.2f)));
    } else {
        world_.warn("textures " + claray::quoted(node.type) + " are not supported, and what they would colour is grey");
    }
    if (result.varies()) set_coordinates(result.use, node);
    return result;
}

Alphas MitsubaMaterials::alphas(const MitsubaNode& bsdf, double otherwise) {
    const auto luminance = [](const glm::vec3& c) { return glm::vec3(luminance_of(c)); };
    const auto scalar = [&](std::string_view name, const Paint& missing) {
        const Paint found = paint(bsdf, name, missing);
        return found.varies() ? world_.paints().changed(found, "luminance", luminance) : found;
    };
    const Paint both = scalar("alpha", Paint(float(otherwise)));
    return {scalar("alpha_u", both), scalar("alpha_v", both), bsdf.text("distribution", "beckmann") == "beckmann"};
}

float MitsubaMaterials::ior(const MitsubaNode& bsdf, double inside) {
    const auto side = [&](std::string_view name, double otherwise) {
        const MitsubaNode* found = bsdf.property(name);
        if (!found || found->tag != "string") return bsdf.number(name, otherwise);
        const auto known = ior_named(found->value("value"));
        if (!known)
            found->refuse("the index of " + claray::quoted(found->value("value")) + " is unknown", "give a number");
        return double(*known);
    };
    return float(side("int_ior", inside) / side("ext_ior", 1.000277));
}

// ---- BSDFs

Look MitsubaMaterials::metal(const MitsubaNode& bsdf) {
    Conductor conductor{glm::vec3(0.f), glm::vec3(1.f)};
    const std::string name = bsdf.text("material", "none");
    if (const auto known = conductor_named(name))
        conductor = *known;
    else
        world_.warn("the metal " + claray::quoted(name) + " is unknown: it reflects all light");
    if (bsdf.property("eta")) conductor.eta = world_.paints().mean(paint(bsdf, "eta", Paint(0.f)));
    if (bsdf.property("k")) conductor.k = world_.paints().mean(paint(bsdf, "k", Paint(1.f)));
    const Paint tint = paint(bsdf, "specular_reflectance", Paint(1.f));
    return metal_look(world_.paints(), Paint(schlick_color(conductor)),
                      alphas(bsdf, bsdf.type == "conductor" ? 0 : 0.1), tint);
}

/// Disney's parameters (Burley 2012, 2015) as glTF's: its coat has a quarter of the strength.
Look MitsubaMaterials::principled(const MitsubaNode& bsdf) {
    const Paint base = paint(bsdf, "base_color", Paint(0.5f));
    const auto number = [&](std::string_view name, float otherwise) {
        return std::clamp(world_.paints().mean(paint(bsdf, name, Paint(otherwise))).x, 0.f, 1.f);
    };
    const float aspect = std::sqrt(1 - 0.9f * number("anisotropic", 0.f));
    const auto widened = [](float by) { return [by](const glm::vec3& r) { return glm::clamp(r * r * by, 0.f, 1.f); }; };
    const Paint roughness = paint(bsdf, "roughness", Paint(0.5f));
    const Alphas lobes{world_.paints().changed(roughness, "squared along", widened(1 / aspect)),
                       world_.paints().changed(roughness, "squared across", widened(aspect))};
    const float specular = number("specular", 0.5f), root = std::sqrt(0.08f * specular);
    const float ior = std::clamp(float(bsdf.number("eta", (1 + root) / (1 - root))), 1.f, 10.f);
    Look look = burley_look(world_.paints(), base, number("metallic", 0.f), ior, lobes);
    Material& m = look.material;
    m.transmission = number("spec_trans", 0.f);
    if (m.transmission > 0.f) set_albedo(m, world_.paints(), base);
    m.clearcoat = 0.25f * number("clearcoat", 0.f);
    m.clearcoat_roughness = std::sqrt(std::clamp(0.1f + number("clearcoat_gloss", 0.f) * (0.001f - 0.1f), 0.f, 1.f));
    const float sheen = number("sheen", 0.f);
    if (sheen > 0.f) m.sheen = glm::vec3(sheen), m.sheen_roughness = 0.5f;
    if (number("flatness", 0.f) > 0.f || number("diff_trans", 0.f) > 0.f)
        world_.warn("flatness and diffuse transmission of principled BSDFs are left out");
    return look;
}

Look MitsubaMaterials::nested(const MitsubaNode& bsdf, std::size_t index, int depth) {
    for (const MitsubaNode& each : bsdf.children) {
        const MitsubaNode* object = resolved(each);
        if (!object || object->tag != "bsdf") continue;
        if (index-- == 0) return make(*object, depth + 1);
    }
    bsdf.refuse("a BSDF within this one is missing", "add one");
}

Look MitsubaMaterials::relief(const MitsubaNode& bsdf, int depth) {
    Look look = nested(bsdf, 0, depth);
    if (bsdf.type == "normalmap") {
        look.material.normal_map = paint(bsdf, "normalmap", Paint(0.5f)).use;
        return look;
    }
    const MitsubaNode* image = child(bsdf, "texture");
    if (!image) return look;
    look.material.height_map = texture(*image).use;
    look.material.height_scale = float(bsdf.number("scale", 1));
    return look;
}

Look MitsubaMaterials::make_nested(const MitsubaNode& bsdf, int depth) {
    if (bsdf.type == "twosided") {
        Look look = nested(bsdf, 0, depth);
        look.both_sides = true;
        return look;
    }
    if (bsdf.type == "mask") {
        Look look = nested(bsdf, 0, depth);
        const Paint opacity = paint(bsdf, "opacity", Paint(0.5f));
        set_opacity(look, world_.paints(), world_.paints().changed(opacity, "luminance", [](const glm::vec3& c) {
            return glm::vec3(luminance_of(c));
        }));
        return look;
    }
    if (bsdf.type == "blendbsdf") {
        const Look first = nested(bsdf, 0, depth), second = nested(bsdf, 1, depth);
        return mixed_look(world_.paints(), first, second, paint(bsdf, "weight", Paint(0.5f)));
    }
    return relief(bsdf, depth);
}

Look MitsubaMaterials::make(const MitsubaNode& bsdf, int depth) {
    if (depth > most_bsdfs_deep) bsdf.refuse("BSDFs are more than 32 deep", "check that none refers to itself");
    const std::string& type = bsdf.type;
    Paints& paints = world_.paints();
    if (is_one_of(type, {"twosided", "mask", "blendbsdf", "bumpmap", "normalmap"})) return make_nested(bsdf, depth);
    Look look;
    look.both_sides = false;
    if (type == "diffuse") {
        look = diffuse_look(paints, paint(bsdf, "reflectance", Paint(0.5f)));
        look.both_sides = false;
    } else if (type == "plastic" || type == "roughplastic") {
        look = plastic_look(paints, paint(bsdf, "diffuse_reflectance", Paint(0.5f)), ior(bsdf, 1.49),
                            alphas(bsdf, type == "plastic" ? 0 : 0.1), bsdf.flag("nonlinear", false));
        const float specular = std::clamp(paints.mean(paint(bsdf, "specular_reflectance", Paint(1.f))).x, 0.f, 1.f);
        look.material.specular_weight = specular;
        look.both_sides = false;
    } else if (type == "conductor" || type == "roughconductor") {
        look = metal(bsdf);
        look.both_sides = false;
    } else if (type == "dielectric" || type == "roughdielectric") {
        look = glass_look(paints, ior(bsdf, 1.5046), alphas(bsdf, type == "dielectric" ? 0 : 0.1),
                          paint(bsdf, "specular_transmittance", Paint(1.f)));
    } else if (type == "thindielectric") {
        look = pane_look(paints, ior(bsdf, 1.5046), paint(bsdf, "specular_transmittance", Paint(1.f)));
    } else if (type == "principled" || type == "principledthin") {
        look = principled(bsdf);
        look.material.thin_walled = type == "principledthin";
        look.both_sides = look.material.transmission > 0.f;
    } else if (type == "null") {
        look.invisible = true;
    } else {
        world_.warn("BSDFs " + claray::quoted(type) + " are not supported: they are diffuse");
        look = diffuse_look(paints, paint(bsdf, "reflectance", paint(bsdf, "diffuse_reflectance", Paint(0.5f))));
    }
    return look;
}

}  // namespace claray
