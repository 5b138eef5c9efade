// The drivers of OpenCL: files *.icd that name their libraries (cl_khr_icd), and what fails in them.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace claray {

struct Icd {
    std::filesystem::path file;
    std::string library;
};

/// In $OCL_ICD_VENDORS, a folder or a file, else in /etc/OpenCL/vendors, as the loaders ocl-icd and Khronos' take them.
[[nodiscard]] std::vector<Icd> installed_icds();

/// Lists the devices of all drivers in a child process, before the first call of OpenCL. Where that process crashes or
/// hangs, the drivers that do so are left out of $OCL_ICD_VENDORS. The cache remembers the drivers that pass.
void leave_out_crashing_drivers();

/// One line for each driver that was left out: its file, its library and why.
[[nodiscard]] const std::vector<std::string>& crashing_drivers();
/// These, and a line for each driver that cannot be loaded or finds no platform.
[[nodiscard]] std::vector<std::string> failing_drivers();

}  // namespace claray
