// claray.h: materials, lights, sky and camera.
#include "host/capi/members.hpp"
#include "host/capi/scene.hpp"

using namespace claray;
using namespace claray::capi;

namespace {

/// Writes the members of C++'s standard object.
template <class Cpp, class C>
claray_status init(C* place, const char* name) {
    return guarded([&] {
        static const Cpp standard{};  // whose texts stay
        give(place, put_into<C>(standard), name);
    });
}

claray_material material_of(const Material& material) {
    auto known = put_into<claray_material>(material);
    known.parameters = material.parameters.data(), known.parameter_count = material.parameters.size();
    return known;
}

Material material_of(const claray_material& given) {
    Material material;
    visit_pairs(given, material, Take{"material"});
    material.parameters = copied<float>(given.parameters, given.parameter_count, "material.parameters");
    return material;
}

Camera camera_of(const claray_camera& given) {
    Camera camera;
    visit_pairs(given, camera, Take{"camera"});
    if (given.moves_position != 0) take(given.position_end, camera.position_end.emplace(), "camera.position_end");
    if (given.moves_target != 0) take(given.target_end, camera.target_end.emplace(), "camera.target_end");
    return camera;
}

void give_camera(claray_camera* place, const Camera& camera) {
    auto known = put_into<claray_camera>(camera);
    known.moves_position = camera.position_end ? 1 : 0, known.moves_target = camera.target_end ? 1 : 0;
    put(known.position_end, camera.position_end.value_or(glm::vec3(0.f)));
    put(known.target_end, camera.target_end.value_or(glm::vec3(0.f)));
    give(place, known, "camera");
}

void check_positive(float value, const char* name) {
    if (!(value > 0)) refuse(std::string(name) + " is " + std::to_string(value), "use a number above 0");
}

}  // namespace

claray_status claray_material_init(claray_material* material) { return init<Material>(material, "material"); }
claray_status claray_light_init(claray_light* light) { return init<Light>(light, "light"); }
claray_status claray_camera_init(claray_camera* camera) { return init<Camera>(camera, "camera"); }

claray_status claray_scene_material_set(claray_scene* scene, size_t index, const claray_material* material) {
    return guarded([&] {
        Scene& to = required(scene, "scene").scene;
        set_element(to.materials, index, material_of(versioned(&required(material, "material"), "material")),
                    "materials");
    });
}
claray_status claray_scene_material_get(const claray_scene* scene, size_t index, claray_material* material) {
    return guarded([&] {
        give(material, material_of(element(required(scene, "scene").scene.materials, index, "materials")), "material");
    });
}

claray_status claray_add_bsdf(const char* name, const char* source, uint32_t parameters, uint32_t* number) {
    return guarded([&] {
        CustomBsdf bsdf{&required(name, "name"), &required(source, "source"), parameters};
        std::uint32_t& place = required(number, "number");
        place = add_bsdf(std::move(bsdf));
    });
}

claray_status claray_scene_light_set(claray_scene* scene, size_t index, const claray_light* light) {
    return guarded([&] {
        Scene& to = required(scene, "scene").scene;
        Light known;
        visit_pairs(versioned(&required(light, "light"), "light"), known, Take{"light"});
        set_element(to.lights, index, std::move(known), "lights");
    });
}
claray_status claray_scene_light_get(const claray_scene* scene, size_t index, claray_light* light) {
    return guarded([&] {
        give(light, put_into<claray_light>(element(required(scene, "scene").scene.lights, index, "lights")), "light");
    });
}

claray_status claray_scene_sky_set(claray_scene* scene, const claray_sky* sky) {
    return guarded([&] {
        Scene& to = required(scene, "scene").scene;
        visit_pairs(versioned(&required(sky, "sky"), "sky"), to.sky, Take{"sky"});
    });
}
claray_status claray_scene_sky_get(const claray_scene* scene, claray_sky* sky) {
    return guarded([&] { give(sky, put_into<claray_sky>(required(scene, "scene").scene.sky), "sky"); });
}

claray_status claray_scene_camera_set(claray_scene* scene, const claray_camera* camera) {
    return guarded([&] {
        Scene& to = required(scene, "scene").scene;
        if (camera)
            to.camera = camera_of(versioned(camera, "camera"));
        else
            to.camera.reset();
    });
}
claray_status claray_scene_camera_get(const claray_scene* scene, float aspect, claray_camera* camera) {
    return guarded([&] {
        const Scene& of = required(scene, "scene").scene;
        check_positive(aspect, "aspect");
        give_camera(camera, claray::camera_of(of, aspect));
    });
}
claray_status claray_scene_camera_fit(const claray_scene* scene, const float* bounds, float vertical_fov, float aspect,
                                      claray_camera* camera) {
    return guarded([&] {
        check_positive(aspect, "aspect");
        check_positive(vertical_fov, "vertical_fov");
        if (bounds) {
            const Bounds box{{bounds[0], bounds[1], bounds[2]}, {bounds[3], bounds[4], bounds[5]}};
            return give_camera(camera, automatic_camera(box, vertical_fov, aspect));
        }
        give_camera(camera, automatic_camera(required(scene, "scene").scene, vertical_fov, aspect));
    });
}
claray_status claray_camera_orbit(claray_camera* camera, float degrees) {
    return guarded([&] {
        const claray_camera given = versioned(&required(camera, "camera"), "camera");
        give_camera(camera, orbited(camera_of(given), degrees));
    });
}
