// Installed as pbrt, lightlab and imgtool if there are builds for several instruction sets; executes the program of
// that name for the best supported one. Links to nothing that loads slowly.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace {

struct InstructionSet {
    const char *name;
    bool isSupported;
};

}  // namespace

/// Each instruction set has an install tree ../lib/pbrt_octree/SET/bin/NAME. Uses the best installed set that the
/// processor supports, or that of the environment variable PBRT_INSTRUCTION_SET.
int main(int, char **argv) {
    std::error_code failed;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failed);
    const std::filesystem::path folder = self.parent_path().parent_path() / "lib/pbrt_octree";
    const std::string name = self.filename().string();
    const char *wish = std::getenv("PBRT_INSTRUCTION_SET");
    std::string choices;
    __builtin_cpu_init();
    // Best first. The names are those of the x86-64 psABI.
    const InstructionSet sets[] = {{"x86-64-v4", __builtin_cpu_supports("x86-64-v4") != 0},
                                   {"x86-64-v3", __builtin_cpu_supports("x86-64-v3") != 0},
                                   {"x86-64", true}};
    for (const InstructionSet &set : sets) {
        const std::string program = (folder / set.name / "bin" / name).string();
        if (!set.isSupported || access(program.c_str(), X_OK) != 0) continue;
        choices += (choices.empty() ? "" : ", ") + std::string(set.name);
        if (wish && *wish && std::string(wish) != set.name) continue;
        execv(program.c_str(), argv);
        std::perror(("Error: " + program).c_str());
        return 1;
    }
    if (choices.empty())
        std::fprintf(stderr, "Error: %s: no program %s was installed for this processor.\n", folder.c_str(),
                     name.c_str());
    else
        std::fprintf(stderr, "Error: PBRT_INSTRUCTION_SET is \"%s\"; valid on this machine: %s.\n", wish,
                     choices.c_str());
    return 1;
}
