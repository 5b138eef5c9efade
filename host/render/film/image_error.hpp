// The error of several images against one reference.
#pragma once

#include <vector>

#include "claray/image/image_error.hpp"

namespace claray {

/// Keeps what image_error needs of the reference: half of its work. Runs on all processors.
class ErrorAgainst {
public:
    /// Throws ErrorKind::usage if the image is empty or has no whole rows.
    ErrorAgainst(std::vector<glm::vec3> reference, unsigned width);
    /// As image_error.
    [[nodiscard]] ImageError operator()(std::span<const glm::vec3> image) const;

private:
    std::vector<glm::vec3> reference_, seen_;
    unsigned width_;
    double mean_;
};

}  // namespace claray
