// Intel's Open Image Denoise, loaded at run time if it is installed.
#pragma once

#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

namespace claray {

/// Linear radiance, and what guides the denoiser: albedo 0 to 1, and normals. All of width x height pixels.
struct OidnImages {
    unsigned width = 0, height = 0;
    std::vector<glm::vec3> color, albedo, normal;
};

class Oidn {
public:
    /// Looks for the library $CLARAY_OIDN, or else for libOpenImageDenoise where the system keeps libraries. Returns
    /// null if there is none.
    [[nodiscard]] static std::unique_ptr<Oidn> load();
    /// As above; throws ErrorKind::user if there is none.
    [[nodiscard]] static std::unique_ptr<Oidn> load_or_throw();
    ~Oidn();
    Oidn(const Oidn&) = delete;
    Oidn& operator=(const Oidn&) = delete;

    /// Returns the denoised colour. Throws ErrorKind::device with the library's message.
    [[nodiscard]] std::vector<glm::vec3> denoise(OidnImages images);

private:
    struct Functions;
    Oidn() = default;
    void* library_ = nullptr;
    void* device_ = nullptr;
    std::unique_ptr<Functions> call_;
};

}  // namespace claray
