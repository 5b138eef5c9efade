#include "tests/fuzz/targets.hpp"

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>

#include "claray/effects.hpp"
#include "claray/io.hpp"
#include "host/base/hash.hpp"
#include "host/compute/tuning.hpp"
#include "host/io/mitsuba/serialized.hpp"
#include "host/io/scene_readers.hpp"
#include "host/render/checkpoint/checkpoint.hpp"
#include "tests/fuzz/forge.hpp"
#include "tests/support/device.hpp"
#include "tests/support/process.hpp"

namespace claray::test {
namespace {

using Bytes = std::span<const std::uint8_t>;

/// A folder in memory where there is one, for the whole process.
std::filesystem::path path_of(const std::string& name) {
    static const TemporaryFolder folder;
    return folder / name;
}

std::filesystem::path written(const std::string& name, Bytes bytes) {
    const std::filesystem::path path = path_of(name);
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), std::streamsize(bytes.size()));
    return path;
}

/// Whether there was a result.
template <class Read>
bool expect_result_or_user_error(Read&& read) {
    try {
        read();
        return true;
    } catch (const Error& error) {
        if (error.kind() == ErrorKind::user && std::strlen(error.what()) > 0) return false;
        std::fprintf(stderr, "an error of kind %d: %s\n", int(error.kind()), error.what());
        std::abort();
    }
}

/// What a loader returns must be a scene that a renderer takes.
void check(const Scene& scene) {
    try {
        validate(scene);
    } catch (const Error& error) {
        std::fprintf(stderr, "the loader let through: %s\n", error.what());
        std::abort();
    }
    (void)bounds_of(scene);
    (void)triangle_count(scene);
    (void)effects_of(scene);
}

bool fuzz_obj(Bytes bytes) {
    const auto path = written("input.obj", bytes);
    return expect_result_or_user_error([&] {
        Warnings warnings;
        check(load_obj(path, warnings));
    });
}

bool fuzz_mtl(Bytes bytes) {
    static const std::string obj = "mtllib input.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl a\nf 1/1 2/1 3/1\n";
    const auto path = written("fixed.obj", {reinterpret_cast<const std::uint8_t*>(obj.data()), obj.size()});
    (void)written("input.mtl", bytes);
    return expect_result_or_user_error([&] {
        Warnings warnings;
        check(load_obj(path, warnings));
    });
}

bool fuzz_gltf(Bytes bytes) {
    const bool binary = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
    const auto path = written(binary ? "input.glb" : "input.gltf", bytes);
    LoadOptions options;
    const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    if (text.find("\"channels\"") != text.npos) options.time = 0.3, options.animation = "all";
    return expect_result_or_user_error([&] {
        Warnings warnings;
        try {
            check(load_gltf(path, warnings, options));
        } catch (const Error& error) {
            if (error.kind() != ErrorKind::usage) throw;  // usage: the file has no animation to choose
        }
    });
}

bool fuzz_ply(Bytes bytes) {
    const auto path = written("input.ply", bytes);
    return expect_result_or_user_error([&] {
        Warnings warnings;
        check(load_ply(path, warnings));
    });
}

bool fuzz_stl(Bytes bytes) {
    const auto path = written("input.stl", bytes);
    return expect_result_or_user_error([&] {
        Warnings warnings;
        check(load_stl(path, warnings));
    });
}

bool fuzz_3mf(Bytes bytes) { return read_scene("input.3mf", bytes); }

bool fuzz_pcd(Bytes bytes) { return read_scene("input.pcd", bytes); }

bool fuzz_pbrt(Bytes bytes) {
    const auto path = written("input.pbrt", bytes);
    return expect_result_or_user_error([&] {
        Warnings warnings;
        check(load_pbrt_without_light(path, warnings, {}));
    });
}

bool fuzz_mitsuba(Bytes bytes) {
    const auto path = written("input.xml", bytes);
    return expect_result_or_user_error([&] {
        Warnings warnings;
        check(load_mitsuba_without_light(path, warnings, {}));
    });
}

bool fuzz_serialized(Bytes bytes) {
    const auto path = written("input.serialized", bytes);
    return expect_result_or_user_error([&] { (void)load_serialized(path, 0); });
}

bool fuzz_image(Bytes bytes) {
    const auto path = written("input.image", bytes);
    return expect_result_or_user_error([&] {
        const Texture texture = load_image(path);
        const std::size_t values = std::size_t(texture.width) * texture.height * texture.channels;
        if (texture.bytes.size() + texture.floats.size() != values || values == 0) std::abort();
    });
}

/// With the layout that is stored: nothing but the file's counts and sizes decides what happens.
bool fuzz_tree(Bytes bytes) {
    std::vector<std::uint8_t> file(bytes.begin(), bytes.end());
    mend_digests(file, tree_header);
    const auto path = written("input.cbvh", file);
    return expect_result_or_user_error([&] { (void)Bvh::load(device(), path, Layout::binary); });
}

/// As if it were of this very render.
bool fuzz_checkpoint(Bytes bytes) {
    std::vector<std::uint8_t> file(bytes.begin(), bytes.end());
    constexpr std::size_t header = 152, digests = 88;  // docs/formats.md
    mend_digests(file, header);
    const auto path = written("input.checkpoint", file);
    RenderIdentity identity;
    identity.width = identity.height = 2;
    if (file.size() >= header) {
        for (Digest* digest : {&identity.scene, &identity.settings, &identity.kernels})
            std::memcpy(digest->data(), file.data() + digests + 16 * (digest - &identity.scene), digest->size());
    }
    return expect_result_or_user_error([&] { (void)read_checkpoint(path, identity, 8); });
}

bool fuzz_tuning(Bytes bytes) {
    DeviceInfo info;
    info.name = "device";
    return expect_result_or_user_error([&] {
        Tuning tuning;
        apply_users_tuning(std::string(bytes.begin(), bytes.end()), "input", info, tuning);
        if (!tuning.values.empty()) std::abort();  // nothing can be tuned here
    });
}

constexpr FuzzTarget targets[] = {{"obj", fuzz_obj},
                                  {"mtl", fuzz_mtl},
                                  {"gltf", fuzz_gltf},
                                  {"ply", fuzz_ply},
                                  {"stl", fuzz_stl},
                                  {"pcd", fuzz_pcd},
                                  {"3mf", fuzz_3mf},
                                  {"pbrt", fuzz_pbrt},
                                  {"mitsuba", fuzz_mitsuba},
                                  {"serialized", fuzz_serialized},
                                  {"image", fuzz_image},
                                  {"tree", fuzz_tree},
                                  {"checkpoint", fuzz_checkpoint},
                                  {"tuning", fuzz_tuning}};

}  // namespace

std::span<const FuzzTarget> fuzz_targets() { return targets; }

bool read_scene(const char* name, std::span<const std::uint8_t> bytes) {
    const auto path = written(name, bytes);
    return expect_result_or_user_error([&] {
        Warnings warnings;
        check(load_scene(path.string(), warnings));
    });
}

}  // namespace claray::test
