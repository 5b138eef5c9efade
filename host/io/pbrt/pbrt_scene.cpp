#include "host/io/pbrt/pbrt_scene.hpp"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "host/io/words.hpp"

namespace claray {
namespace {

constexpr std::size_t most_blocks = 1024;  // one within the other

glm::dmat4 look_at(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up) {
    const glm::dvec3 forward = glm::normalize(target - eye),
                     right = glm::normalize(glm::cross(glm::normalize(up), forward));
    glm::dmat4 to_world(1.0);
    to_world[0] = glm::dvec4(right, 0), to_world[1] = glm::dvec4(glm::cross(forward, right), 0);
    to_world[2] = glm::dvec4(forward, 0), to_world[3] = glm::dvec4(eye, 1);
    return glm::inverse(to_world);
}

}  // namespace

void PbrtScene::read() {
    now_.material = materials_.add("diffuse", {});
    for (PbrtToken token = tokens_.next(); token.kind != PbrtToken::Kind::end; token = tokens_.next()) {
        if (token.kind != PbrtToken::Kind::word)
            tokens_.refuse("a statement is expected instead of " + claray::quoted(token.value),
                           "check the statement before it");
        follow(token.value);
    }
    if (has_camera_) world_.set_view(view_);
}

void PbrtScene::follow(const std::string& statement) {
    if (follow_transform(statement)) return;
    if (statement == "Shape") return add_shape();
    if (statement == "LightSource") return add_light();
    if (statement == "AreaLightSource") {
        const std::string kind = tokens_.next_text();
        now_.lamp = {parameters_of("light"), true};
        if (kind != "diffuse") world_.warn("area lights " + claray::quoted(kind) + " are shown as 'diffuse'");
    } else if (statement == "Material") {
        const std::string kind = tokens_.next_text();
        now_.material = materials_.add(kind, parameters_of("material"));
    } else if (statement == "MakeNamedMaterial") {
        const std::string name = tokens_.next_text();
        materials_.add_named(name, parameters_of("material"));
    } else if (statement == "NamedMaterial") {
        const std::string name = tokens_.next_text();
        const auto found = materials_.named(name);
        if (!found) world_.warn("the material " + claray::quoted(name) + " is not defined: it is diffuse");
        now_.material = found ? *found : materials_.add("diffuse", {});
    } else if (statement == "Texture") {
        const std::string name = tokens_.next_text(), of = tokens_.next_text(), kind = tokens_.next_text();
        materials_.add_texture(name, of, kind, parameters_of("texture"));
    } else if (statement == "ReverseOrientation") {
        now_.reversed = !now_.reversed;
    } else if (statement == "Include" || statement == "Import") {
        tokens_.include(tokens_.next_text());
    } else if (statement == "Camera") {
        set_camera();
    } else if (statement == "Film") {
        set_film();
    } else {
        follow_blocks(statement);
    }
}

void PbrtScene::follow_blocks(const std::string& statement) {
    if (statement == "AttributeBegin" || statement == "TransformBegin") return push();
    if (statement == "AttributeEnd" || statement == "TransformEnd") {
        const State ended = now_;
        pop();
        if (statement == "TransformEnd") {  // of pbrt-v3: other attributes stay
            const State outer = now_;
            now_ = ended;
            now_.to_world = outer.to_world;
        }
    } else if (statement == "ObjectBegin") {
        if (!object_.empty()) tokens_.refuse("an object begins within an object", "end the first one before");
        push();
        object_ = tokens_.next_text();
        world_.set_group(object_);
    } else if (statement == "ObjectEnd") {
        if (object_.empty()) tokens_.refuse("no object has begun", "check the blocks before");
        pop();
        object_.clear();
        world_.set_group({});
    } else if (statement == "ObjectInstance") {
        const std::string name = tokens_.next_text();
        if (!object_.empty()) tokens_.refuse("an object is placed within an object", "place it outside");
        if (!world_.has_group(name))
            tokens_.refuse("the object " + claray::quoted(name) + " is not defined", "define it before");
        // Objects hold their shapes in the coordinates of the mirrored scene.
        world_.place(name, placed() * glm::inverse(mirror_));
    } else if (statement == "WorldBegin") {
        now_.to_world = glm::dmat4(1.0), now_.moves_start = true;
        systems_["world"] = now_.to_world;
        in_world_ = true;
    } else if (statement == "Attribute") {
        const std::string target = tokens_.next_text();
        PbrtParameters fresh = PbrtParameters::read(tokens_);
        fresh.add_defaults(now_.defaults[target]);
        now_.defaults[target] = std::move(fresh);
    } else if (statement == "MediumInterface") {
        (void)tokens_.next_text();
        if (tokens_.peek().kind == PbrtToken::Kind::text) (void)tokens_.next_text();
    } else if (statement == "MakeNamedMedium") {
        (void)tokens_.next_text(), (void)PbrtParameters::read(tokens_);
        world_.warn("media, such as fog and smoke, are left out");
    } else if (statement == "ColorSpace") {
        const std::string space = tokens_.next_text();
        if (space != "srgb") world_.warn("colours of the space " + claray::quoted(space) + " are read as sRGB");
    } else if (statement == "Sampler" || statement == "Integrator" || statement == "PixelFilter" ||
               statement == "Accelerator" || statement == "SurfaceIntegrator" || statement == "VolumeIntegrator") {
        (void)tokens_.next_text(), (void)PbrtParameters::read(tokens_);
    } else if (statement == "Option") {
        (void)PbrtParameters::read(tokens_);
    } else if (statement != "WorldEnd") {
        tokens_.refuse("the statement " + claray::quoted(statement) + " is unknown", "check its spelling");
    }
}

void PbrtScene::push() {
    if (stack_.size() >= most_blocks) tokens_.refuse("blocks are more than 1024 deep", "check that they end");
    stack_.push_back(now_);
}

void PbrtScene::pop() {
    if (stack_.empty()) tokens_.refuse("a block ends that has not begun", "check the blocks before");
    now_ = std::move(stack_.back());
    stack_.pop_back();
}

// ---- transforms

void PbrtScene::apply(const glm::dmat4& transform) {
    if (now_.moves_start) now_.to_world = now_.to_world * transform;
}

/// pbrt writes matrices column by column, as GLM stores them.
glm::dmat4 PbrtScene::next_matrix() {
    const bool list = tokens_.peek().kind == PbrtToken::Kind::begin_list;
    if (list) (void)tokens_.next();
    glm::dmat4 matrix;
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = tokens_.next_number();
    if (list && tokens_.next().kind != PbrtToken::Kind::end_list)
        tokens_.refuse("a matrix has more than 16 numbers", "check the statement");
    return matrix;
}

bool PbrtScene::follow_transform(const std::string& statement) {
    const auto next_vector = [&] {
        glm::dvec3 v;
        for (int k = 0; k < 3; ++k) v[k] = tokens_.next_number();
        return v;
    };
    if (statement == "Identity") {
        if (now_.moves_start) now_.to_world = glm::dmat4(1.0);
    } else if (statement == "Translate") {
        apply(glm::translate(glm::dmat4(1.0), next_vector()));
    } else if (statement == "Scale") {
        apply(glm::scale(glm::dmat4(1.0), next_vector()));
    } else if (statement == "Rotate") {
        const double degrees = tokens_.next_number();
        const glm::dvec3 axis = next_vector();
        if (glm::length(axis) > 0) apply(glm::rotate(glm::dmat4(1.0), degrees * std::numbers::pi / 180, axis));
    } else if (statement == "LookAt") {
        const glm::dvec3 eye = next_vector(), target = next_vector(), up = next_vector();
        if (!(glm::length(glm::cross(target - eye, up)) > 0))
            tokens_.refuse("LookAt's up is along its view", "give another up vector");
        apply(look_at(eye, target, up));
    } else if (statement == "ConcatTransform") {
        apply(next_matrix());
    } else if (statement == "Transform") {
        const glm::dmat4 matrix = next_matrix();
        if (now_.moves_start) now_.to_world = matrix;
    } else if (statement == "CoordinateSystem") {
        systems_[tokens_.next_text()] = now_.to_world;
    } else if (statement == "CoordSysTransform") {
        const auto found = systems_.find(tokens_.next_text());
        if (found == systems_.end()) tokens_.refuse("the coordinate system is not defined", "define it before");
        now_.to_world = found->second;
    } else if (statement == "TransformTimes") {
        for (int i = 0; i < 2; ++i) (void)tokens_.next_number();
    } else if (statement == "ActiveTransform") {
        const PbrtToken which = tokens_.next();
        now_.moves_start = which.value != "EndTime";
        if (!now_.moves_start) world_.warn("motion is left out: the scene is as it is when the shutter opens");
    } else {
        return false;
    }
    return true;
}

glm::dmat4 PbrtScene::placed() const { return mirror_ * now_.to_world; }

PbrtParameters PbrtScene::parameters_of(const std::string& target) {
    PbrtParameters parameters = PbrtParameters::read(tokens_);
    if (const auto found = now_.defaults.find(target); found != now_.defaults.end())
        parameters.add_defaults(found->second);
    return parameters;
}

// ---- the camera

void PbrtScene::set_film() {
    const SceneFilm film = next_film(tokens_);
    view_.width = film.width, view_.height = film.height;
}

void PbrtScene::set_camera() {
    const std::string kind = tokens_.next_text();
    const PbrtParameters p = PbrtParameters::read(tokens_);
    const glm::dmat4 to_world = glm::inverse(now_.to_world);
    systems_["camera"] = to_world;
    const double turn = glm::determinant(glm::dmat3(to_world));
    if (!(std::abs(turn) > 1e-30 && std::isfinite(turn)))
        tokens_.refuse("the camera's transform is not invertible", "check the statements before");
    if (turn > 0) mirror_ = glm::scale(glm::dmat4(1.0), glm::dvec3(-1, 1, 1));
    view_.to_world = mirror_ * to_world;
    view_.fov = p.number("fov", 90);
    view_.lens_radius = p.number("lensradius", 0), view_.focus_distance = p.number("focaldistance", 1e6);
    view_.half_height = view_.width >= view_.height ? 1 : view_.height / view_.width;
    if (const std::vector<double>& window = p.numbers("screenwindow"); window.size() == 4) {
        view_.half_height = (window[3] - window[2]) / 2;
        if (std::abs(window[3] + window[2]) + std::abs(window[1] + window[0]) > 1e-6)
            world_.warn("the camera's view is centred: a screen window aside of the middle is not supported");
        if (kind == "perspective") {
            view_.fov =
                360 / std::numbers::pi * std::atan(std::tan(view_.fov * std::numbers::pi / 360) * view_.half_height);
            view_.fov_along = View::Along::height;
        }
    }
    if (kind == "orthographic") view_.projection = Projection::orthographic;
    if (kind == "spherical") view_.projection = Projection::panorama;
    if (kind == "realistic") world_.warn("the camera 'realistic' is shown as 'perspective'");
    has_camera_ = true;
}

}  // namespace claray
