// What `claray attest` writes: a device, its driver, and what all cases of `verify` found there.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/cli/options/case_options.hpp"

namespace claray::cli {

/// How long a render takes to its first sample, if nothing is compiled.
struct FirstPicture {
    std::string scene;
    double seconds = 0;          ///< from the start of the renderer to the first sample of every pixel
    double compile_seconds = 0;  ///< of compilers, of all threads
    std::string failure = {};    ///< why there is none
};

/// A case as the page shows it.
struct AttestedCase {
    std::string name;
    bool holds = false;
    std::string reason = {};  ///< why it fails; or the known fault that claray avoids
    bool known = false;       ///< it holds, since claray avoids what is wrong
};

struct Attestation {
    std::string name;  ///< of the file, without folder and extension
    std::string claray, kernels, platform, device, driver, opencl, opencl_c, type;
    unsigned compute_units = 0;
    bool fp64 = false;
    std::string date, effort;
    double seconds = 0;
    std::vector<FirstPicture> first_pictures = {};
    std::vector<AttestedCase> cases = {};
};

/// JSON, a line for each case.
[[nodiscard]] std::string attestation_text(const Verified& verified, const VerifyOptions& options,
                                           const std::string& opencl_c, const std::vector<FirstPicture>& pictures);

/// Throws ErrorKind::user for a file that is no attestation, or not a whole one.
[[nodiscard]] Attestation read_attestation(const std::filesystem::path& file);

/// Markdown: a table of the devices, and one of all cases. Sorted by the names of the files.
[[nodiscard]] std::string attestation_page(std::vector<Attestation> attestations);

}  // namespace claray::cli
