#include "pbrt/integrators/pass_parts.h"

#include "pbrt/core/hand_out.h"
#include "pbrt/core/parallel.h"

namespace pbrt {

namespace {

/// Brings together at the first process what of a pass the processes have done. `whole`: how many parts this one has
/// finished. `before`: RenderPass::done when the pass began. Returns, everywhere, whether all parts are whole; if not,
/// `progress` is cancelled everywhere.
bool ReducePass(const RenderPass &pass, int64_t parts, int64_t whole, int64_t unreported,
                const std::vector<uint32_t> &before) {
    struct Sums {
        int64_t whole, unreported;
    } sums{whole, unreported};
    pass.ranks->Reduce([&](StateWriter &out) { out.Value(sums); },
                       [&](StateReader &in) {
                           const auto theirs = in.Value<Sums>();
                           sums.whole += theirs.whole;
                           sums.unreported += theirs.unreported;
                       });
    if (pass.isCounted && pass.ranks->IsFirst()) pass.progress.Advance(sums.unreported);
    StateWriter verdict;
    verdict.Value(sums.whole == parts);
    const std::string answer = pass.ranks->Broadcast(verdict);
    if (StateReader(answer, "message").Value<bool>()) return true;
    // A process that was cancelled after it had asked for its last part could not say so.
    pass.progress.Cancel();
    if (!pass.done) return false;
    // What is done must be known part by part.
    struct Done {
        uint32_t part, samples;
    };
    std::vector<Done> changed;
    for (size_t i = 0; i < before.size(); ++i)
        if ((*pass.done)[i] != before[i]) changed.push_back({static_cast<uint32_t>(i), (*pass.done)[i]});
    pass.ranks->Reduce([&](StateWriter &out) { out.Vector(changed); },
                       [&](StateReader &in) {
                           std::vector<Done> also;
                           in.Vector(&also);
                           changed.insert(changed.end(), also.begin(), also.end());
                       });
    for (const Done &d : changed) (*pass.done)[d.part] = d.samples;
    return false;
}

}  // namespace

bool RenderParts(const RenderPass &pass, const PassParts &parts) {
    if (pass.done && pass.done->empty()) pass.done->assign(static_cast<size_t>(parts.count), 0);
    const auto doneBefore = [&](int64_t i) { return pass.done ? (*pass.done)[static_cast<size_t>(i)] : 0; };
    for (int64_t i = 0; pass.done && i < parts.count; ++i)
        if (pass.done->size() != static_cast<size_t>(parts.count) || doneBefore(i) > parts.samplesOf(i))
            throw UserError(fmt::format("{}: what is left of a pass does not fit the picture.", pass.doneFile));
    if (parts.splat) pass.film.ExpectSplats();
    std::atomic<int64_t> whole = 0;
    std::atomic<uint64_t> paths = 0;
    // Returns how many samples were added to a part that is now whole.
    const auto render = [&](int64_t i) {
        const uint32_t before = doneBefore(i);
        const uint32_t done = parts.render(i, before);
        if (pass.done) (*pass.done)[static_cast<size_t>(i)] = done;
        paths.fetch_add(done - before, std::memory_order_relaxed);
        if (done < parts.samplesOf(i)) return int64_t{0};
        whole.fetch_add(1, std::memory_order_relaxed);
        return int64_t{done} - int64_t{before};
    };
    const auto countPaths = [&] {
        if (parts.splat && pass.keepsSamples) pass.film.AddSplatPaths(paths);
    };
    if (!pass.ranks) {
        ParallelForEach(parts.count, [&](int64_t i) {
            const int64_t added = render(i);
            if (pass.isCounted && added > 0) pass.progress.Advance(added);
        });
        countPaths();
        return whole == parts.count;
    }
    const std::vector<uint32_t> before = pass.done ? *pass.done : std::vector<uint32_t>();
    HandOut handOut(*pass.ranks, parts.count, ThreadCount(), pass.progress);
    ParallelForEach(ThreadCount(), [&](int64_t) {
        while (const std::optional<int64_t> i = handOut.Take()) {
            const int64_t added = render(*i);
            if (pass.isCounted && added > 0) handOut.Report(added);
        }
    });
    const int64_t unreported = handOut.Finish();
    countPaths();
    return ReducePass(pass, parts.count, whole, unreported, before);
}

}  // namespace pbrt
