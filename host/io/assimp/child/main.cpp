// claray-import FILE [FORMAT]: a scene of another program as a binary glTF on standard output, by Assimp.
// It is a program of its own, because readers of so many formats have errors: what they break is this process only.
#include <assimp/BaseImporter.h>
#include <assimp/postprocess.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>
#include <csignal>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <exception>

#include "host/base/host_memory.hpp"
#include "host/base/message.hpp"
#include "host/io/assimp/child/conversion.hpp"

namespace claray::assimp {
namespace {

void limit(int what, rlim_t most) {
    rlimit now{};
    if (::getrlimit(decltype(RLIMIT_AS)(what), &now) != 0 || now.rlim_max <= most) return;
    now = {most, most};
    ::setrlimit(decltype(RLIMIT_AS)(what), &now);
}

/// A damaged file may ask for any memory and time, and an error may write any file.
void limit_resources() {
    constexpr rlim_t seconds = 600;
    limit(RLIMIT_AS, rlim_t(claray::free_host_memory() / 4 * 3));
    limit(RLIMIT_CPU, seconds);
    limit(RLIMIT_CORE, 0);
    ::prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0);
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
}

/// One reader, so that no other one takes the file.
bool keep_reader(Assimp::Importer& importer, const std::string& format) {
    const std::size_t kept = importer.GetImporterIndex(format.c_str());
    if (kept == std::size_t(-1)) return false;
    std::vector<Assimp::BaseImporter*> others;
    for (std::size_t i = 0; i < importer.GetImporterCount(); ++i)
        if (i != kept) others.push_back(importer.GetImporter(i));
    for (Assimp::BaseImporter* other : others) importer.UnregisterLoader(other);
    return true;
}

int fail(const std::string& what) {
    std::fprintf(stderr, "%s\n", claray::one_line(what, 200).c_str());
    return 1;
}

int import(const std::filesystem::path& file, const std::string& format) {
    Assimp::Importer importer;
    if (!keep_reader(importer, format)) return fail("Assimp has no reader for ." + format);
    auto* const folder = new SceneFolder(file, format);  // the importer owns it
    importer.SetIOHandler(folder);
    importer.SetPropertyBool(AI_CONFIG_IMPORT_NO_SKELETON_MESHES, true);  // in place of meshes that a file lacks
    constexpr unsigned steps = aiProcess_Triangulate | aiProcess_JoinIdenticalVertices | aiProcess_SortByPType |
                               aiProcess_FindInvalidData | aiProcess_GenUVCoords | aiProcess_TransformUVCoords |
                               aiProcess_ValidateDataStructure;
    const aiScene* const scene = importer.ReadFile(folder->scene(), steps);
    if (scene == nullptr || scene->mRootNode == nullptr) return fail(importer.GetErrorString());
    Glb glb;
    LeftOut left_out;
    add_materials(glb, *scene, *folder, left_out);
    add_nodes(glb, *scene, left_out);
    for (const auto& [what, count] : left_out)
        if (count > 0) std::fprintf(stderr, "left out: %s (%zu)\n", what.c_str(), count);
    return glb.write(stdout) ? 0 : fail("the scene is larger than a .glb may be, 4 GiB");
}

}  // namespace
}  // namespace claray::assimp

int main(int count, char** arguments) {
    if (count != 2 && count != 3) {
        std::fprintf(stderr, "usage: claray-import FILE [FORMAT] >FILE.glb\n");
        return 2;
    }
    const std::filesystem::path file(arguments[1]);
    std::string format = count == 3 ? arguments[2] : file.extension().string();
    if (format.starts_with('.')) format.erase(0, 1);
    if (::isatty(STDOUT_FILENO) != 0) return claray::assimp::fail("standard output is a terminal: write to a file");
    try {
        claray::assimp::limit_resources();
        return claray::assimp::import(file, format);
    } catch (const std::bad_alloc&) {
        return claray::assimp::fail("there is not enough memory");
    } catch (const std::exception& error) {
        return claray::assimp::fail(error.what());
    }
}
