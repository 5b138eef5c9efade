#include "host/compute/programs/joint_program.hpp"

#include <algorithm>
#include <set>

namespace claray {
namespace {

/// Empty if there is none. If a macro is given twice the compiler uses the last value.
std::string value_of(const ProgramRequest& request, const std::string& macro) {
    for (auto define = request.defines.rbegin(); define != request.defines.rend(); ++define)
        if (define->first == macro) return define->second;
    return {};
}

/// The default of a macro; empty if none of the headers has one.
std::string default_of(const std::vector<const KernelSource*>& headers, const std::string& macro) {
    const std::string directive = "#ifndef " + macro + "\n#define " + macro + ' ';
    for (const KernelSource* header : headers) {
        const std::size_t at = header->text.find(directive);
        if (at == std::string::npos) continue;
        const std::size_t begin = at + directive.size();
        return header->text.substr(begin, header->text.find_first_of(" \n", begin) - begin);
    }
    return {};
}

/// The headers that both files include.
std::vector<const KernelSource*> shared_headers(const ProgramRequest& a, const ProgramRequest& b) {
    std::vector<const KernelSource*> of_a = included_sources(kernel_source(a.file).text);
    const std::vector<const KernelSource*> of_b = included_sources(kernel_source(b.file).text);
    std::erase_if(
        of_a, [&](const KernelSource* header) { return std::find(of_b.begin(), of_b.end(), header) == of_b.end(); });
    return of_a;
}

std::set<std::string> macros_of(const ProgramRequest& request) {
    std::set<std::string> macros;
    for (const auto& [name, value] : request.defines) macros.insert(name);
    return macros;
}

bool can_share(const ProgramRequest& a, const ProgramRequest& b) {
    if (a.file == b.file) return false;
    std::set<std::string> macros = macros_of(a);
    macros.merge(macros_of(b));
    const std::vector<const KernelSource*> headers = shared_headers(a, b);
    return std::none_of(macros.begin(), macros.end(), [&](const std::string& macro) {
        const auto mentioning = [&](const KernelSource* header) { return mentions(*header, macro); };
        if (std::none_of(headers.begin(), headers.end(), mentioning)) return false;
        const std::string otherwise = default_of(headers, macro), of_a = value_of(a, macro), of_b = value_of(b, macro);
        return (of_a.empty() ? otherwise : of_a) != (of_b.empty() ? otherwise : of_b);
    });
}

}  // namespace

JointSource join(const std::vector<ProgramRequest>& requests) {
    JointSource joint{{"several kernels", {}}, {}};
    std::set<std::string> defined;
    for (const ProgramRequest& request : requests) {
        const auto fits = [&](const ProgramRequest& member) { return can_share(member, request); };
        if (!std::all_of(joint.members.begin(), joint.members.end(), fits)) continue;
        for (const std::string& macro : defined) joint.source.text += "#undef " + macro + '\n';
        defined = macros_of(request);
        for (const std::string& macro : defined)
            joint.source.text += "#define " + macro + ' ' + value_of(request, macro) + '\n';
        joint.source.text += "#include \"" + request.file + "\"\n";
        joint.members.push_back(request);
    }
    return joint;
}

}  // namespace claray
