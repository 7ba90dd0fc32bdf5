#pragma once
#include <algorithm>
#include <cmath>

#include "pbrt/core/online_model.h"
#include "pbrt/core/parallel.h"
#include "pbrt/core/progress.h"
#include "pbrt/integrators/render_loop.h"

namespace pbrt {

/// Renders pass after pass; samples are in batches with their own samplers. The integrator's OnlineModel is updated
/// between passes, at its sample counts. Any split into calls gives the same image.
class WaveRenderer {
  public:
    WaveRenderer(const RenderContext &context, const RenderSettings &settings)
        : context_(context), model_(context.integrator.Model()), settings_(settings), samplers_(ThreadCount()),
          oddSamplers_(context.half ? ThreadCount() : 0) {
        if (!context.half) return;
        position_.plan.cost.resize(PixelCells(context.film.PixelBounds()).Count());
        position_.plan.halfBlock = HalfBlock(settings.samplesPerPixel, settings.noise > 0);
    }

    /// Renders up to `count` more samples per pixel, within the batch. Returns the number rendered; 0 if cancelled.
    int Render(int count) {
        const int batch = settings_.samplesPerPixel;
        DecideIfDue();
        const int left = context_.half ? position_.plan.end - Done() : batch - Done() % batch;
        int size = std::min({count, left, context_.integrator.MaxPassSamples()});
        UpdateIfDue();
        if (model_ && model_->NextUpdate() > 0) size = std::min(size, model_->NextUpdate() - Done());
        if (context_.progress.Cancelled()) return 0;
        // The rest of a cancelled pass comes first.
        if (position_.passCount > 0) size = position_.passCount;
        position_.passCount = size;
        Send(Command::Pass);
        return RenderPassOf(size) ? size : 0;
    }
    /// Updates the model if due before the next sample. Also done by Render; for callers that time them separately.
    void UpdateIfDue() {
        if (!model_ || model_->NextUpdate() == 0 || Done() != model_->NextUpdate() || context_.progress.Cancelled())
            return;
        Send(Command::Update);
        UpdateTogether();
    }
    /// In adaptive renders, plans the samples up to the next decision if the last plan is done. Also done by Render.
    void DecideIfDue() {
        SamplePlan &plan = position_.plan;
        // A resumed render estimates the noise anew, and plans the same from the same sums.
        const bool isDue = Done() == plan.end || (!isDecided_ && Done() == plan.begin);
        if (!context_.half || position_.passCount > 0 || !isDue) return;
        UpdateIfDue();
        if (context_.progress.Cancelled()) return;
        isDecided_ = true;
        const int uniform =
            std::max(PilotSamples(settings_.samplesPerPixel, plan.halfBlock), model_ ? model_->NextUpdate() : 0);
        if (Done() < uniform) {
            plan.begin = Done();
            plan.end = uniform;
        } else {
            Gather();
            Decide();
        }
        Send(Command::Plan);
    }
    /// Noise estimated by the last decision of this object.
    const std::optional<double> &Noise() const { return noise_; }
    int Done() const { return position_.done; }
    const RenderPosition &Position() const { return position_; }
    /// Resumes from this position, which film and integrator are in.
    void GoOnFrom(RenderPosition position) {
        position.plan.halfBlock = position_.plan.halfBlock;
        position_ = std::move(position);
    }
    /// Continues at this sample, as the film already holds (Film::Load) or skips those before. Samples that the
    /// integrator learns from are traced again.
    void ContinueFrom(int samples) {
        isRepeating_ = true;
        while (model_ && model_->NextUpdate() > 0 && Done() < samples)
            if (Render(samples - Done()) == 0) break;
        isRepeating_ = false;
        position_ = {.done = samples};
    }

    /// On rank 0: gathers the films' sums and the models' records; required before either is read.
    void Gather() {
        Send(Command::Gather);
        GatherHere();
    }
    /// On rank 0, after the last call of the above.
    void EndTogether() { Send(Command::End); }
    /// On other ranks: executes the commands of rank 0 until it ends.
    void Follow() {
        for (;;) {
            const std::string command = context_.team.Broadcast({});
            StateReader in(command, "command");
            switch (in.Value<Command>()) {
                case Command::Pass:
                    in(position_.done, position_.passCount, isRepeating_, position_.passDone);
                    RenderPassOf(position_.passCount);
                    break;
                case Command::Update: UpdateTogether(); break;
                case Command::Plan: {
                    // Rank 0 has the cost up to the last Gather, this process its own since then.
                    std::vector<uint64_t> cost = std::move(position_.plan.cost);
                    in(position_.plan);
                    position_.plan.cost = std::move(cost);
                    break;
                }
                case Command::Gather: GatherHere(); break;
                case Command::End: return;
            }
        }
    }

  private:
    enum class Command { Pass, Update, Plan, Gather, End };
    void Send(Command command) {
        StateWriter out;
        out.Value(command);
        if (command == Command::Pass) out(position_.done, position_.passCount, isRepeating_, position_.passDone);
        if (command == Command::Plan) out(position_.plan);
        context_.team.Broadcast(out);
    }
    /// Of the gathered films.
    void Decide() {
        SamplePlan &plan = position_.plan;
        const NoiseEstimate estimate = EstimateNoise(context_.film, *context_.half, plan, Done()).value();
        noise_ = std::sqrt(estimate.relL2);
        int end = NextDecision(Done(), settings_.samplesPerPixel);
        int horizon = std::max(end, settings_.samplesPerPixel);
        if (settings_.noise > 0) {
            const double enough = std::ceil(SamplesForNoise(Done(), *noise_, settings_.noise));
            end = int(std::clamp(enough, std::min(Done() + 2.0, double(end)), double(end)));
            horizon = int(std::clamp(enough, double(end), double(horizon)));
        }
        plan = PlanSamples(PixelCells(context_.film.PixelBounds()), plan, estimate, Done(), end, horizon);
    }
    bool RenderPassOf(int size) {
        const int batch = settings_.samplesPerPixel;
        if (int round = context_.half ? 0 : Done() / batch; round != round_) {
            round_ = round;
            const auto fill = [&](std::vector<std::unique_ptr<Sampler>> &samplers, int index) {
                const std::unique_ptr<Sampler> prototype = context_.sampler.ForBatch(index);
                // The samples of adaptive renders differ by AdaptiveSampleIndex.
                if (!context_.half) prototype->SkipSamples(int64_t{index} * batch);
                for (std::unique_ptr<Sampler> &s : samplers) s = prototype->Clone();
            };
            fill(samplers_, round);
            if (context_.half) fill(oddSamplers_, 1);
        }
        std::optional<AdaptivePass> adaptive;
        if (context_.half)
            adaptive.emplace(AdaptivePass{position_.plan, *context_.half,
                                          settings_.noise > 0 ? oddSamplers_ : samplers_, position_.plan.cost});
        const RenderPass pass{.camera = context_.camera,
                              .filter = context_.filter,
                              .film = context_.film,
                              .samplers = samplers_,
                              .samplesPerPixel = batch,
                              .samplesBefore = settings_.samplesBefore,
                              .batchFirst = round_ * batch,
                              .first = Done() - round_ * batch,
                              .count = size,
                              .jittersPixels = !settings_.disablePixelJitter,
                              .jittersWavelengths = !settings_.disableWavelengthJitter,
                              .keepsSamples = !isRepeating_,
                              .isCounted = settings_.HasKnownEnd() && !isRepeating_,
                              .done = &position_.passDone,
                              .doneFile = position_.file,
                              .progress = context_.progress,
                              .adaptive = adaptive ? &*adaptive : nullptr,
                              .team = context_.team};
        if (!context_.integrator.Render(pass)) return false;
        position_ = {.done = Done() + size, .plan = std::move(position_.plan)};
        return true;
    }
    void UpdateTogether() {
        Team &team = context_.team;
        // All models are updated from the same records.
        team.AllReduce([&](StateWriter &out) { model_->ExtractRecords(out); },
                       [&](StateReader &in) { model_->MergeRecords(in); });
        const int before = model_->NextUpdate();
        model_->Update(context_.progress);
        // A process cancelled meanwhile has its old model; all processes then stop.
        bool areAllUpdated = model_->NextUpdate() != before;
        team.Reduce([&](StateWriter &out) { out.Value(areAllUpdated); },
                    [&](StateReader &in) { areAllUpdated = in.Value<bool>() && areAllUpdated; });
        if (team.BroadcastValue(areAllUpdated)) return;
        isBrokenOff_ = true;
        context_.progress.Cancel();
    }
    void GatherHere() {
        const bool learns = model_ && model_->NextUpdate() > 0 && !isBrokenOff_;
        context_.team.Reduce(
            [&](StateWriter &out) {
                context_.film.TakeSums(out);
                if (context_.half) {
                    context_.half->TakeSums(out);
                    for (uint64_t &cost : position_.plan.cost) out.Value(std::exchange(cost, 0));
                }
                if (learns) model_->ExtractRecords(out);
            },
            [&](StateReader &in) {
                context_.film.AddSums(in);
                if (context_.half) {
                    context_.half->AddSums(in);
                    for (uint64_t &cost : position_.plan.cost) cost += in.Value<uint64_t>();
                }
                if (learns) model_->MergeRecords(in);
            });
    }
    const RenderContext context_;
    OnlineModel *const model_;
    const RenderSettings &settings_;
    std::vector<std::unique_ptr<Sampler>> samplers_, oddSamplers_;  ///< one per thread
    int round_ = -1;
    bool isDecided_ = false;
    std::optional<double> noise_;
    RenderPosition position_;
    bool isBrokenOff_ = false;  ///< some process lacks a model update; rank 0 has all records
    bool isRepeating_ = false;  ///< the film already has the samples being rendered
};

}  // namespace pbrt
