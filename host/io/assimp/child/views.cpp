// Cameras and lights.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "host/io/assimp/child/conversion.hpp"

namespace claray::assimp {
namespace {

/// A matrix that looks along -z, as cameras and lights of glTF do; none where the directions are none.
std::optional<Json> looking(const aiVector3D& position, aiVector3D direction, aiVector3D up) {
    aiVector3D back = -direction;
    if (!(back.Length() > 0) || !std::isfinite(back.Length()) || !std::isfinite(position.Length())) return {};
    back.Normalize();
    aiVector3D right = up ^ back;
    if (!(right.Length() > 1e-6f)) right = aiVector3D(back.y, back.z, back.x) ^ back;
    if (!(right.Length() > 0)) return {};
    right.Normalize();
    up = back ^ right;
    return Json{right.x, right.y, right.z, 0, up.x,       up.y,       up.z,       0,
                back.x,  back.y,  back.z,  0, position.x, position.y, position.z, 1};
}

aiMatrix4x4 to_world(const aiNode* node) {
    aiMatrix4x4 matrix;
    for (; node != nullptr; node = node->mParent) matrix = node->mTransformation * matrix;
    return matrix;
}

/// Where a camera or a light stands in its node. Assimp states the places of 3DS files here and in the node.
aiVector3D place_in_node(const aiScene& scene, const aiString& name, const aiVector3D& position) {
    const aiNode* const node = scene.mRootNode->FindNode(name);
    if (node == nullptr) return position;
    const aiMatrix4x4& m = node->mTransformation;
    const ai_real distance = (aiVector3D(m.a4, m.b4, m.c4) - position).Length();
    return distance <= ai_real(1e-5) * position.Length() ? aiVector3D() : position;
}

/// The direction to the node NAME.Target, which 3ds Max adds for what looks there, whatever its own rotation is.
aiVector3D direction_in_node(const aiScene& scene, const aiString& name, const aiVector3D& own) {
    const aiNode *const node = scene.mRootNode->FindNode(name), *const target = scene.mRootNode->FindNode(
                                                                    (std::string(name.C_Str()) + ".Target").c_str());
    if (node == nullptr || target == nullptr) return own;
    const aiVector3D direction = to_world(node).Inverse() * (to_world(target) * aiVector3D());
    return direction.Length() > 0 && std::isfinite(direction.Length()) ? direction : own;
}

void add_camera(Glb& glb, const aiScene& scene, const aiCamera& source, std::size_t node) {
    const std::optional<Json> matrix = looking(place_in_node(scene, source.mName, source.mPosition),
                                               direction_in_node(scene, source.mName, source.mLookAt), source.mUp);
    if (!matrix) return;
    const double aspect = source.mAspect > 0 && std::isfinite(source.mAspect) ? double(source.mAspect) : 4.0 / 3;
    Json camera = {{"name", source.mName.C_Str()}};
    if (source.mOrthographicWidth > 0) {
        const double width = double(source.mOrthographicWidth);
        camera["type"] = "orthographic";
        camera["orthographic"] = {{"xmag", width}, {"ymag", width / aspect}, {"znear", 0}, {"zfar", 1e6}};
    } else {
        const double wide = std::clamp(double(source.mHorizontalFOV), 0.01, 3.1);
        const double high = 2 * std::atan(std::tan(wide / 2) / aspect);
        camera["type"] = "perspective";
        camera["perspective"] = {{"yfov", high}, {"znear", 0.01}};
    }
    const std::size_t index = glb.push("cameras", std::move(camera));
    const std::size_t child =
        glb.push("nodes", {{"name", source.mName.C_Str()}, {"camera", index}, {"matrix", *matrix}});
    glb.root["nodes"][node]["children"].push_back(child);
}

/// Of the file's unit, where Assimp has scaled the root; attenuations count in it, whatever the nodes' scales are.
double scale_of(const aiScene& scene) {
    const double volume = std::abs(double(aiMatrix3x3(scene.mRootNode->mTransformation).Determinant()));
    return volume > 0 && std::isfinite(volume) ? std::cbrt(volume) : 1;
}

/// Light of rasterizers: a white surface that faces a light of colour 1 is white, which takes an irradiance of pi. It
/// falls by 1 / (a0 + a1 d + a2 d^2), where glTF knows only the last. `metres`: in a unit of the light.
std::optional<Json> light_of(const aiLight& source, double metres) {
    Json light = {{"name", source.mName.C_Str()}};
    if (source.mType == aiLightSource_SPOT) {
        const auto half = [](float angle) { return std::clamp(0.5 * double(angle), 0.0, std::numbers::pi / 2); };
        const double outer = std::max(half(source.mAngleOuterCone), 1e-3);
        light["type"] = "spot";
        light["spot"] = {{"innerConeAngle", std::min(half(source.mAngleInnerCone), 0.999 * outer)},
                         {"outerConeAngle", outer}};
    } else if (source.mType == aiLightSource_DIRECTIONAL || source.mType == aiLightSource_POINT) {
        light["type"] = source.mType == aiLightSource_POINT ? "point" : "directional";
    } else {
        return {};
    }
    const aiColor3D& color = source.mColorDiffuse;
    const float most = std::max({color.r, color.g, color.b});
    if (!(most > 0) || !std::isfinite(most)) return {};
    const auto part = [&](float c) { return std::clamp(c / most, 0.f, 1.f); };
    light["color"] = {part(color.r), part(color.g), part(color.b)};
    light["intensity"] = std::numbers::pi * double(most);
    const double a[3] = {double(source.mAttenuationConstant), double(source.mAttenuationLinear) / metres,
                         double(source.mAttenuationQuadratic) / (metres * metres)};
    const bool given = std::all_of(std::begin(a), std::end(a), [](double x) { return x >= 0 && std::isfinite(x); }) &&
                       a[0] + a[1] + a[2] > 0;
    if (source.mType != aiLightSource_DIRECTIONAL)
        light["extensions"]["CLARAY_attenuation"]["constants"] = given ? Json{a[0], a[1], a[2]} : Json{1, 0, 0};
    return light;
}

void add_light(Glb& glb, const aiScene& scene, const aiLight& source, std::size_t node, double metres,
               LeftOut& left_out) {
    std::optional<Json> light = light_of(source, metres);
    const aiVector3D direction = source.mType == aiLightSource_POINT
                                     ? aiVector3D(0, 0, -1)
                                     : direction_in_node(scene, source.mName, source.mDirection);
    const std::optional<Json> matrix =
        looking(place_in_node(scene, source.mName, source.mPosition), direction, aiVector3D(0, 1, 0));
    if (!light || !matrix) {
        const bool is_black = source.mColorDiffuse.IsBlack();
        left_out["ambient lights and lights with an area"] += !light && !is_black;
        return;
    }
    if (light->contains("extensions")) glb.use("CLARAY_attenuation");
    glb.use("KHR_lights_punctual");
    Json& lights = glb.root["extensions"]["KHR_lights_punctual"]["lights"];
    lights.push_back(*std::move(light));
    const Json reference = {{"KHR_lights_punctual", {{"light", lights.size() - 1}}}};
    const std::size_t child =
        glb.push("nodes", {{"name", source.mName.C_Str()}, {"matrix", *matrix}, {"extensions", reference}});
    glb.root["nodes"][node]["children"].push_back(child);
}

}  // namespace

void add_cameras_and_lights(Glb& glb, const aiScene& scene, const std::map<std::string, std::size_t>& nodes,
                            double metres, LeftOut& left_out) {
    const auto node_of = [&](const aiString& name) {
        const auto found = nodes.find(name.C_Str());
        return found == nodes.end() ? std::size_t(0) : found->second;
    };
    for (const aiCamera* camera : std::span(scene.mCameras, scene.mNumCameras))
        add_camera(glb, scene, *camera, node_of(camera->mName));
    for (const aiLight* light : std::span(scene.mLights, scene.mNumLights))
        add_light(glb, scene, *light, node_of(light->mName), metres * scale_of(scene), left_out);
}

}  // namespace claray::assimp
