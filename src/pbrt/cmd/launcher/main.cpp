// Stands under the names pbrt, lightlab and imgtool where the programs are installed for several instruction sets, and
// becomes the program of that name that is built for the best one which the processor has. It links to nothing that is
// slow to load.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

namespace {

struct InstructionSet {
    const char *name;
    bool isSupported;
};

/// The best comes first. The names are those of the x86-64 psABI.
std::vector<InstructionSet> InstructionSets() {
    __builtin_cpu_init();
    return {{"x86-64-v4", __builtin_cpu_supports("x86-64-v4") != 0},
            {"x86-64-v3", __builtin_cpu_supports("x86-64-v3") != 0},
            {"x86-64", true}};
}

}  // namespace

/// Every set's programs are an installed folder of their own: ../lib/pbrt_octree/SET/bin/NAME. The best set that the
/// processor has, and that was built, is taken; the environment variable PBRT_INSTRUCTION_SET names another one.
int main(int, char **argv) {
    std::error_code failed;
    const std::filesystem::path self = std::filesystem::read_symlink("/proc/self/exe", failed);
    const std::filesystem::path folder = self.parent_path().parent_path() / "lib/pbrt_octree";
    const std::string name = self.filename().string();
    const char *wish = std::getenv("PBRT_INSTRUCTION_SET");
    std::string choices;
    for (const InstructionSet &set : InstructionSets()) {
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
