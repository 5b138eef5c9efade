#include "host/bsdf/custom_bsdfs.hpp"

#include <algorithm>
#include <cctype>

#include "claray/error.hpp"
#include "host/compute/programs/kernel_sources.hpp"

namespace claray {
namespace {

std::vector<CustomBsdf>& added() {
    static std::vector<CustomBsdf> bsdfs;
    return bsdfs;
}

bool is_identifier(const std::string& name) {
    const auto fits = [](unsigned char c) { return std::isalnum(c) || c == '_'; };
    return !name.empty() && !std::isdigit(static_cast<unsigned char>(name[0])) &&
           std::all_of(name.begin(), name.end(), fits);
}

/// Returns whether claray has a BSDF of that name, or a function that the BSDF would also define.
bool is_taken(const std::string& name) {
#define CLARAY_ROW(own, NAME, text, transmits, lobes, rough) #own,
    for (const char* own : {CLARAY_BSDFS(CLARAY_ROW) "bsdf", "kind", "layers", "nothing", "below_coat"})
#undef CLARAY_ROW
        if (name == own) return true;
    return std::any_of(added().begin(), added().end(), [&](const CustomBsdf& bsdf) { return bsdf.name == name; });
}

/// The text of a function that calls that of the material's BSDF.
std::string choice(const std::string& head, const std::string& function, const std::string& arguments,
                   const std::string& otherwise) {
    std::string text = "static inline " + head + " {\n";
    for (std::size_t i = 0; i < added().size(); ++i)
        text += "    if (material->custom == " + std::to_string(i) + "u) return " + function + '_' + added()[i].name +
                '(' + arguments + ");\n";
    return text + "    return " + otherwise + ";\n}\n";
}

/// kernels/bsdf/custom.clh for the BSDFs added so far.
std::string source() {
    std::string text =
        "#pragma once\n#include \"bsdf/ggx.clh\"\n"
        "static inline global const float* parameters_of(const MaterialData* material, const BsdfView* "
        "view) {\n    return view->tables + material->energy;\n}\n";
    for (const CustomBsdf& bsdf : added()) text += "#line 1 \"" + bsdf.name + "\"\n" + bsdf.source + '\n';
    text += "#line 1 \"bsdf/custom.clh\"\n";
    text +=
        choice("float3 eval_custom(const MaterialData* material, const BsdfView* view, float3 incoming, float* pdf)",
               "eval", "material, view, incoming, pdf", "eval_nothing(pdf)");
    text += choice(
        "bool sample_custom(const MaterialData* material, const BsdfView* view, float3 random, "
        "BsdfSample* sample)",
        "sample", "material, view, random, sample", "false");
    text += choice("bool is_delta_custom(const MaterialData* material)", "is_delta", "material", "false");
    return text;
}

}  // namespace

std::span<const CustomBsdf> custom_bsdfs() { return added(); }

std::uint32_t add_bsdf(CustomBsdf bsdf) {
    if (!is_identifier(bsdf.name))
        throw Error(ErrorKind::usage, "'" + bsdf.name + "' is not a name of a BSDF", "use letters, digits and _");
    if (is_taken(bsdf.name))
        throw Error(ErrorKind::usage, "there is a BSDF '" + bsdf.name + "' already", "choose another name");
    added().push_back(std::move(bsdf));
    replace_kernel_source("bsdf/custom.clh", source());
    return std::uint32_t(added().size() - 1);
}

void check_custom(const Material& material) {
    if (material.kind != MaterialKind::custom) return;
    const std::string what = "the material '" + material.name + "'";
    if (material.custom >= added().size())
        throw Error(
            ErrorKind::user,
            what + " uses the BSDF number " + std::to_string(material.custom) + " of " + std::to_string(added().size()),
            "add it with add_bsdf");
    const CustomBsdf& bsdf = added()[material.custom];
    if (material.parameters.size() != bsdf.parameters)
        throw Error(ErrorKind::user, what + " has " + std::to_string(material.parameters.size()) + " parameters",
                    "the BSDF '" + bsdf.name + "' reads " + std::to_string(bsdf.parameters));
}

}  // namespace claray
