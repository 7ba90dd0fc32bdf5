#include <dlfcn.h>

#include <cstdlib>

#include "pbrt/core/team.h"

namespace pbrt {
namespace {

std::optional<int> NumberInEnvironment(const char *name) {
    const char *text = std::getenv(name);
    if (!text || !*text) return {};
    char *end = nullptr;
    const long value = std::strtol(text, &end, 10);
    return *end != 0 || value < 0 || value > 1 << 24 ? std::nullopt : std::optional(int(value));
}

}  // namespace

AnnouncedTeam ReadAnnouncedTeam() {
    AnnouncedTeam announced;
    // Open MPI's mpirun sets all three. Slurm's srun --mpi=pmix sets variables of its own.
    if (const auto size = NumberInEnvironment("OMPI_COMM_WORLD_SIZE")) {
        announced.size = *size;
        announced.rank = NumberInEnvironment("OMPI_COMM_WORLD_RANK").value_or(0);
        announced.onThisMachine = NumberInEnvironment("OMPI_COMM_WORLD_LOCAL_SIZE").value_or(1);
    } else if (const auto rank = NumberInEnvironment("PMIX_RANK")) {
        announced.rank = *rank;
        announced.size = NumberInEnvironment("SLURM_NTASKS").value_or(*rank + 1);
    } else if (const auto others = NumberInEnvironment("PMI_SIZE")) {
        announced.size = *others;
        announced.rank = NumberInEnvironment("PMI_RANK").value_or(0);
    }
    return announced;
}

std::unique_ptr<Team> ConnectTeam(int threads) {
    const AnnouncedTeam announced = ReadAnnouncedTeam();
    if (announced.size <= 1) return std::make_unique<Team>();
    const auto fail = [&](const std::string &why) -> std::unique_ptr<Team> {
        if (announced.rank > 0) throw AnotherRankFailed{};
        throw UserError("mpirun started {} processes, but {}.", announced.size, why);
    };
#ifdef PBRT_MPI_MODULE
    // Found by the program's run path. Global, because components that Open MPI loads use its symbols.
    void *module = dlopen(PBRT_MPI_MODULE, RTLD_NOW | RTLD_GLOBAL);
    void *entry = module ? dlsym(module, "PbrtMessagePort") : nullptr;
    if (!entry) return fail(fmt::format("{} cannot be loaded: {}", PBRT_MPI_MODULE, dlerror()));
    std::unique_ptr<MessagePort> port(reinterpret_cast<MessagePort *(*)()>(entry)());
    if (port->Size() != announced.size) return fail("this program supports Open MPI only; another launcher started it");
    return std::make_unique<Team>(std::move(port), threads);
#else
    (void)threads;
    return fail("this program was built without MPI, so each would render the whole image");
#endif
}

}  // namespace pbrt
