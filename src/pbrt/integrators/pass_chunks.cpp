#include "pbrt/integrators/integrator.h"

#include "pbrt/core/work_distributor.h"

namespace pbrt {

namespace {

/// Gathers the progress of all processes on rank 0. `whole`: number of chunks this process finished. `before`:
/// RenderPass::done at the start. Returns, everywhere, whether all chunks are complete; if not, cancels `progress`
/// everywhere.
bool ReducePass(const RenderPass &pass, int64_t chunks, int64_t whole, int64_t unreported,
                const std::vector<uint32_t> &before) {
    struct Sums {
        int64_t whole, unreported;
    } sums{whole, unreported};
    pass.team.Reduce([&](StateWriter &out) { out.Value(sums); },
                     [&](StateReader &in) {
                         const auto theirs = in.Value<Sums>();
                         sums.whole += theirs.whole;
                         sums.unreported += theirs.unreported;
                     });
    if (pass.isCounted && pass.team.IsRank0()) pass.progress.Advance(sums.unreported);
    if (pass.team.BroadcastValue(sums.whole == chunks)) return true;
    // A process cancelled after its last request could not report it.
    pass.progress.Cancel();
    if (!pass.done) return false;
    struct Done {
        uint32_t chunk, samples;
    };
    std::vector<Done> changed;
    for (size_t i = 0; i < before.size(); ++i)
        if ((*pass.done)[i] != before[i]) changed.push_back({uint32_t(i), (*pass.done)[i]});
    pass.team.Reduce([&](StateWriter &out) { out.Vector(changed); },
                     [&](StateReader &in) {
                         std::vector<Done> also;
                         in.Vector(&also);
                         changed.insert(changed.end(), also.begin(), also.end());
                     });
    for (const Done &d : changed) (*pass.done)[d.chunk] = d.samples;
    return false;
}

}  // namespace

bool RenderChunks(const RenderPass &pass, const PassChunks &chunks) {
    if (pass.done && pass.done->empty()) pass.done->assign(size_t(chunks.count), 0);
    const auto doneBefore = [&](int64_t i) { return pass.done ? (*pass.done)[i] : 0; };
    for (int64_t i = 0; pass.done && i < chunks.count; ++i)
        if (pass.done->size() != size_t(chunks.count) || doneBefore(i) > chunks.samplesOf(i))
            throw UserError(fmt::format("{}: what is left of a pass does not fit the picture.", pass.doneFile));
    if (chunks.splat) pass.film.ExpectSplats();
    std::atomic<int64_t> whole = 0;
    std::atomic<uint64_t> paths = 0;
    // Returns the samples added to a chunk that is now complete.
    const auto render = [&](int64_t i) {
        const uint32_t before = doneBefore(i);
        const uint32_t done = chunks.render(i, before);
        if (pass.done) (*pass.done)[i] = done;
        paths.fetch_add(done - before, std::memory_order_relaxed);
        if (done < chunks.samplesOf(i)) return int64_t{0};
        whole.fetch_add(1, std::memory_order_relaxed);
        return int64_t{done} - int64_t{before};
    };
    const std::vector<uint32_t> before = pass.done ? *pass.done : std::vector<uint32_t>();
    const int64_t unreported = DistributeWork(pass.team, chunks.count, pass.progress, [&](int64_t i) {
        const int64_t added = render(i);
        return pass.isCounted ? added : 0;
    });
    if (chunks.splat && pass.keepsSamples) pass.film.AddSplatPaths(paths);
    return ReducePass(pass, chunks.count, whole, unreported, before);
}

}  // namespace pbrt
