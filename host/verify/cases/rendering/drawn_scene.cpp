#include "host/verify/cases/rendering/drawn_scene.hpp"

#include "host/verify/scenes.hpp"

namespace claray::verify {
namespace {

class Draw {
public:
    explicit Draw(std::uint64_t seed) : random_(seed) {}

    Scene scene() {
        Scene scene;
        for (int i = 0; i < 4; ++i) scene.textures.push_back(texture());
        for (int i = 0; i < 5; ++i) scene.materials.push_back(material(scene));
        for (int i = 0; i < 4; ++i) scene.meshes.push_back(mesh(scene));
        const std::uint32_t lights = one_in(3) ? 200 : one_in(2) ? 4 + random_.below(20) : random_.below(4);
        for (std::uint32_t i = 0; i < lights; ++i) scene.lights.push_back(light(lights));
        place(scene);
        add_primitives(scene);
        surround(scene);
        scene.camera = camera();
        if (one_in(4)) scale(scene, one_of({1.f / 256, 64.f}));
        if (one_in(4)) brighten(scene, one_of({1e-5f, 1e4f}));
        return scene;
    }

    RenderConfig config() {
        RenderConfig config{.width = 24, .height = 16, .spp = 4, .seed = random_.below(1000)};
        config.max_depth = one_of({1u, 2u, 5u, default_max_depth});
        if (one_in(5)) config.sample_clamp = random_.uniform(0.1f, 3.f);
        if (one_in(4)) config.sampler = Sampler::independent;
        if (one_in(5)) config.adaptive = true, config.spp = 32;
        return config;
    }

private:
    bool one_in(std::uint32_t count) { return random_.below(count) == 0; }
    template <class T>
    T one_of(std::initializer_list<T> values) {
        return values.begin()[random_.below(std::uint32_t(values.size()))];
    }
    template <class T, std::size_t count>
    const T& one_of(const T (&values)[count]) {
        return values[random_.below(count)];
    }
    /// 0 to 1, often an end or next to it.
    float share() { return one_in(2) ? random_.uniform() : one_of({0.f, 1.f, 1e-3f, 0.03f, 0.999f}); }
    glm::vec3 color() { return {share(), share(), share()}; }
    glm::vec3 radiance(float most) { return most * glm::vec3(random_.uniform(), random_.uniform(), random_.uniform()); }
    float angle() { return random_.uniform(-4.f, 4.f); }

    Texture texture() {
        Texture t;
        t.width = 1 + random_.below(9), t.height = 1 + random_.below(9), t.channels = 1 + random_.below(4);
        t.format = one_of({TexelFormat::srgb8, TexelFormat::linear8, TexelFormat::float32});
        const std::size_t numbers = std::size_t(t.width) * t.height * t.channels;
        for (std::size_t i = 0; i < numbers; ++i) {
            if (t.format == TexelFormat::float32)
                t.floats.push_back(share());
            else
                t.bytes.push_back(std::uint8_t(255.f * share()));
        }
        t.wrap_u = one_of({Wrap::repeat, Wrap::mirror, Wrap::clamp});
        t.wrap_v = one_of({Wrap::repeat, Wrap::mirror, Wrap::clamp});
        t.filter = one_of({Filter::nearest, Filter::bilinear, Filter::trilinear, Filter::nearest_level});
        return t;
    }
    TextureUse use_of_texture(const Scene& scene, std::uint32_t rarity = 4) {
        TextureUse use;
        if (!one_in(rarity)) return use;
        use.texture = random_.below(std::uint32_t(scene.textures.size())), use.uv_set = random_.below(2);
        use.offset = {random_.uniform(-2, 2), random_.uniform(-2, 2)};
        use.scale = {random_.uniform(-3, 3), random_.uniform(-3, 3)}, use.rotation = angle();
        return use;
    }

    Material material(const Scene& scene) {
        Material m;
        m.kind = one_of(material_kinds).kind;
        m.albedo = color(), m.roughness = share(), m.metallic = share();
        m.ior = one_of({1.f, 1.001f, 1.33f, 1.5f, 2.4f});
        if (one_in(5)) m.emission = radiance(3.f);
        m.shininess = one_of({1.f, 20.f, 500.f, 1e5f}), m.specular = 0.5f * color(), m.albedo *= 0.9f;
        m.thin_walled = one_in(4);
        if (one_in(3)) m.transmission = share();
        if (one_in(3)) m.attenuation = color(), m.attenuation_distance = random_.uniform(0.05f, 2.f);
        add_layers(m);
        add_opacity(m);
        add_maps(m, scene);
        return m;
    }
    void add_layers(Material& m) {
        if (one_in(3)) m.clearcoat = share(), m.clearcoat_roughness = share();
        if (one_in(3)) m.specular_weight = share(), m.specular_tint = 2.f * color();
        if (one_in(3)) m.sheen = color(), m.sheen_roughness = share();
        if (one_in(3)) m.anisotropy = share(), m.anisotropy_rotation = angle();
        if (one_in(3)) {
            m.iridescence = share(), m.iridescence_ior = random_.uniform(1.f, 2.5f);
            m.film_thickness = {random_.uniform(0, 400), random_.uniform(0, 1200)};
        }
    }
    void add_opacity(Material& m) {
        m.cull_back = one_in(6);
        if (!one_in(4)) return;
        m.opacity = share(), m.alpha_cutoff = share();
        m.alpha_mode = one_of({AlphaMode::mask, AlphaMode::blend});
        m.alpha_test = one_of({AlphaTest::greater_equal, AlphaTest::greater, AlphaTest::less, AlphaTest::less_equal,
                               AlphaTest::equal, AlphaTest::not_equal});
    }
    void add_maps(Material& m, const Scene& scene) {
        for (const auto map :
             {&Material::albedo_map, &Material::emission_map, &Material::metallic_roughness_map,
              &Material::transmission_map, &Material::clearcoat_map, &Material::clearcoat_roughness_map,
              &Material::clearcoat_normal_map, &Material::specular_map, &Material::specular_weight_map,
              &Material::shininess_map, &Material::sheen_map, &Material::sheen_roughness_map, &Material::anisotropy_map,
              &Material::iridescence_map, &Material::film_thickness_map, &Material::normal_map, &Material::height_map})
            m.*map = use_of_texture(scene);
        m.opacity_map = use_of_texture(scene, 8), m.light_map = use_of_texture(scene, 12);
        m.normal_scale = random_.uniform(0, 2), m.clearcoat_normal_scale = random_.uniform(0, 2);
        m.height_scale = random_.uniform(-0.1f, 0.1f);
    }

    Mesh mesh(const Scene& scene) {
        Mesh mesh;
        switch (random_.below(4)) {
            case 0: mesh = soup(30, 0.5f, random_.below(1000)); break;
            case 1: mesh = square(random_.uniform(0.5f, 4.f), random_.uniform(-1.f, 0.f), 0); break;
            default: mesh = sphere(1 + int(random_.below(2)), random_.uniform(0.1f, 0.9f), random_.in_cube(0.9f));
        }
        mesh.materials.clear();
        const std::uint32_t material = random_.below(std::uint32_t(scene.materials.size()));
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
            mesh.materials.push_back(one_in(8) ? random_.below(std::uint32_t(scene.materials.size())) : material);
        add_attributes(mesh);
        return mesh;
    }
    void add_attributes(Mesh& mesh) {
        mesh.uvs.clear();
        const bool normals = one_in(2), uvs = !one_in(3), more = one_in(2), tangents = one_in(3), colors = one_in(3);
        for (const glm::vec3& p : mesh.positions) {
            if (normals) mesh.normals.push_back(glm::normalize(p + random_.in_cube(0.3f) + glm::vec3(0.f, 1e-3f, 0.f)));
            if (uvs) mesh.uvs.emplace_back(random_.uniform(-1, 2), random_.uniform(-1, 2));
            if (more) mesh.uvs1.emplace_back(random_.uniform(), random_.uniform());
            if (tangents)
                mesh.tangents.emplace_back(glm::normalize(random_.in_cube(1.f) + glm::vec3(1e-3f)),
                                           one_in(2) ? 1.f : -1.f);
            if (colors) mesh.colors.emplace_back(color(), one_in(2) ? 1.f : random_.uniform());
        }
    }

    Light light(std::uint32_t among) {
        Light l;
        l.kind = among > 4 && !one_in(3) ? LightKind::point : one_of(light_kinds).kind;
        l.position = random_.in_cube(one_in(3) ? 1.f : 3.f),
        l.direction = random_.in_cube(1.f) + glm::vec3(0.f, 1e-3f, 0.f);
        l.intensity = radiance((one_in(10) ? 200.f : 8.f) / float(among));
        l.inner_angle = random_.uniform(0.f, 0.5f);
        l.outer_angle = l.inner_angle + random_.uniform(0.05f, 0.9f);
        if (one_in(2)) l.range = random_.uniform(0.5f, 4.f), l.linear_range = one_in(2);
        if (one_in(4)) l.attenuation = {random_.uniform(), random_.uniform(), random_.uniform(0.1f, 1.f)};
        return l;
    }

    void place(Scene& scene) {
        for (int i = 0; i < 6; ++i) {
            MeshInstance instance{random_.below(std::uint32_t(scene.meshes.size())), drawn_transform(random_), {}, {}};
            if (one_in(3)) instance.transform_end = drawn_transform(random_);
            scene.instances.push_back(instance);
        }
    }
    void add_primitives(Scene& scene) {
        for (const PrimitiveSet::Kind kind : {PrimitiveSet::Kind::spheres, PrimitiveSet::Kind::discs,
                                              PrimitiveSet::Kind::cylinders, PrimitiveSet::Kind::curves}) {
            PrimitiveSet set;
            set.kind = kind;
            for (std::uint32_t i = 0; i < 8; ++i) {
                set.points.emplace_back(random_.in_cube(1.f), random_.uniform(0.02f, 0.2f));
                if (kind == PrimitiveSet::Kind::discs && i % 2)
                    set.points.back() = {random_.in_cube(1.f), one_in(2) ? 0.f : 0.01f};
                if (kind == PrimitiveSet::Kind::cylinders && i % 2) set.points.back().w = float(random_.below(2));
            }
            if (are_curves(set)) set.segments = {0, 1, 2, 3, 4};
            for (std::size_t i = 0; i < primitive_count(set); ++i) {
                set.materials.push_back(plain_material(scene, are_curves(set)));
                set.colors.push_back(color()), set.colors.push_back(color());
            }
            scene.primitives.push_back(set);
        }
    }
    /// A new material without maps and opacity, which primitives may have. Curves have no inside.
    std::uint32_t plain_material(Scene& scene, bool opaque) {
        Material m;
        do m.kind = one_of(material_kinds).kind;
        while (opaque && transmits(m.kind));
        m.albedo = color(), m.roughness = share(), m.metallic = share(), m.ior = one_of({1.001f, 1.5f, 2.4f});
        add_layers(m);
        if (one_in(5)) m.emission = radiance(3.f);
        scene.materials.push_back(m);
        return std::uint32_t(scene.materials.size() - 1);
    }

    void surround(Scene& scene) {
        if (one_in(2)) scene.sky.horizon = radiance(1.f), scene.sky.zenith = radiance(2.f);
        if (one_in(4)) {
            scene.sky.fog_color = radiance(1.f), scene.sky.fog_density = random_.uniform(0.01f, 0.4f);
            scene.sky.fog_depth = random_.uniform(1.f, 9.f);
        }
        if (!one_in(3)) return;
        const std::size_t faces = one_in(2) ? 1 : 6;
        Texture face = texture();
        face.channels = 3, face.width = 2 + random_.below(6);
        face.height = faces == 6 ? face.width : 2 + random_.below(6), face.format = TexelFormat::float32;
        for (std::size_t i = 0; i < faces; ++i) {
            face.bytes.clear(), face.floats.clear();
            while (face.floats.size() < std::size_t(face.width) * face.height * 3)
                face.floats.push_back(one_in(20) ? 10.f : share());
            scene.environment.images.push_back(face);
        }
        scene.environment.rotation = angle(), scene.environment.strength = random_.uniform(0.2f, 1.5f);
    }

    /// Half of the moves follow an axis.
    glm::vec3 move() {
        const glm::vec3 any = random_.in_cube(0.3f);
        const unsigned axis = std::bit_cast<std::uint32_t>(any.x) % 6;
        glm::vec3 along(axis < 3 ? 0.f : 1.f);
        if (axis < 3) along[int(axis)] = 1.f;
        return any * along;
    }

    Camera camera() {
        Camera c;
        c.position =
            random_.in_cube(1.f) + one_of({glm::vec3(3.f, 1.f, 0.f), glm::vec3(0.f, 2.f, -3.f), glm::vec3(-2.f)});
        c.target = random_.in_cube(0.5f), c.vertical_fov = random_.uniform(20.f, 90.f);
        if (one_in(3)) c.aperture_radius = random_.uniform(0.01f, 0.3f), c.focus_distance = random_.uniform(0.f, 4.f);
        if (one_in(4)) c.position_end = c.position + move();
        if (one_in(4)) c.target_end = c.target + move();
        if (one_in(2)) c.projection = one_of({Projection::perspective, Projection::orthographic, Projection::panorama});
        if (!traits_of(c.projection)->flat) c.aperture_radius = 0.f;
        return c;
    }

    /// All that shines becomes `by` times as bright.
    static void brighten(Scene& scene, float by) {
        for (Light& light : scene.lights) light.intensity *= by;
        for (Material& m : scene.materials) m.emission *= by;
        scene.sky.horizon *= by, scene.sky.zenith *= by, scene.sky.fog_color *= by;
        for (Texture& image : scene.environment.images)
            for (float& texel : image.floats) texel *= by;
    }
    /// All that is a length becomes `by` times as long, and light as much brighter as distances take from it.
    static void scale(Scene& scene, float by) {
        for (Mesh& mesh : scene.meshes)
            for (glm::vec3& p : mesh.positions) p *= by;
        for (PrimitiveSet& set : scene.primitives)
            for (std::size_t i = 0; i < set.points.size(); ++i) {
                const bool holds_no_radius = points_per_primitive(set.kind) == 2 && !are_curves(set) && i % 2;
                set.points[i] = {by * glm::vec3(set.points[i]), (holds_no_radius ? 1.f : by) * set.points[i].w};
            }
        for (MeshInstance& instance : scene.instances) {
            scale(instance.transform, by);
            if (instance.transform_end) scale(*instance.transform_end, by);
        }
        for (Light& light : scene.lights) {
            light.position *= by, light.range *= by;
            if (!traits_of(light.kind)->far) light.intensity *= by * by;
        }
        for (Material& m : scene.materials) m.attenuation_distance *= by, m.height_scale *= by;
        scene.sky.fog_density /= by, scene.sky.fog_depth *= by;
        Camera& c = *scene.camera;
        c.position *= by, c.target *= by, c.aperture_radius *= by, c.focus_distance *= by, c.orthographic_height *= by;
        if (c.position_end) *c.position_end *= by;
        if (c.target_end) *c.target_end *= by;
    }
    static void scale(glm::mat4& transform, float by) { transform[3] = glm::vec4(by * glm::vec3(transform[3]), 1.f); }

    Random random_;
};

}  // namespace

Scene drawn_scene(std::uint64_t seed, EffectSet allowed) {
    return without_effects(Draw(seed).scene(), known_effects() - allowed);
}

RenderConfig drawn_config(std::uint64_t seed) { return Draw(seed).config(); }

}  // namespace claray::verify
