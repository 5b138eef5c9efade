// A glTF that a test builds and loads.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>

#include "claray/io.hpp"
#include "tests/io/expect_error.hpp"
#include "tests/io/gltf/gltf_builder.hpp"
#include "tests/support/process.hpp"

namespace claray::test {

class GltfTest : public ReaderTest {
protected:
    Scene load(const LoadOptions& options = {}) {
        warnings.clear();
        return load_gltf(folder.file("scene.gltf", builder.gltf()), warnings, options);
    }
    void refuse(std::initializer_list<std::string> words, const LoadOptions& options = {},
                ErrorKind kind = ErrorKind::user) {
        const auto path = folder.file("scene.gltf", builder.gltf());
        expect_error(kind, words, [&] { static_cast<void>(load_gltf(path, warnings, options)); });
    }
    json& primitive() { return builder.root["meshes"][0]["primitives"][0]; }

    GltfBuilder builder;
};

inline void expect_near(const glm::vec3& found, const glm::vec3& expected, float tolerance = 1e-6f) {
    for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(found[k], expected[k], tolerance)
            << "xyz"[k] << " of " << found.x << ' ' << found.y << ' ' << found.z;
}

}  // namespace claray::test
