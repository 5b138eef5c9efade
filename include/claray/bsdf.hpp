// BSDFs of your own, in OpenCL C.
#pragma once

#include <cstdint>
#include <string>

namespace claray {

/// A BSDF that reflects. Materials use it with MaterialKind::custom.
struct CustomBsdf {
    std::string name;  ///< a C identifier, such as "dust"
    /// OpenCL C that defines sample_NAME, eval_NAME and is_delta_NAME as kernels/bsdf/types.clh describes. It may
    /// include the files of kernels/bsdf and kernels/math, and reads Material::parameters by parameters_of(material,
    /// view). Compiler messages name the file NAME.
    std::string source;
    std::uint32_t parameters = 0;  ///< floats in Material::parameters
};

/// Adds a BSDF to the kernels of this process and returns its number for Material::custom. Call it before a Renderer
/// is created; programs compiled earlier stay as they are. Throws ErrorKind::usage if the name is not an identifier or
/// is already in use.
std::uint32_t add_bsdf(CustomBsdf bsdf);

}  // namespace claray
