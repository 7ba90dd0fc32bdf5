#pragma once
#include <algorithm>
#include <initializer_list>
#include <vector>

#include "pbrt/core/progress.h"

namespace pbrt {

class StateReader;
class StateWriter;

/// Extension point: a model estimated from records of the running render. It changes only in Update: between waves,
/// after fixed numbers of samples per pixel. A sample depends only on records of earlier passes, never on thread order.
/// Hence the estimate is unbiased and the image is the same for any thread count and any split into waves.
class OnlineModel {
  public:
    virtual ~OnlineModel() = default;
    /// Samples per pixel after which Update is due; 0: never again, and nothing needs to be recorded.
    virtual int NextUpdate() const = 0;
    /// May take seconds. If `progress` is cancelled, returns soon and leaves the model unchanged.
    virtual void Update(const Progress &progress) = 0;
    /// Processes may share a pass. Before Update, and before the model is saved, their records are merged:
    /// ExtractRecords writes and clears them, MergeRecords adds them. The result is independent of order and division.
    /// MergeRecords throws UserError if the records belong to another model.
    virtual void ExtractRecords(StateWriter &out) = 0;
    virtual void MergeRecords(StateReader &in) = 0;
};

/// Composite of several models, not owned; null ones are skipped.
class OnlineModels final : public OnlineModel {
  public:
    OnlineModels(std::initializer_list<OnlineModel *> models) : models_(models) { std::erase(models_, nullptr); }
    bool IsEmpty() const { return models_.empty(); }
    int NextUpdate() const override {
        int next = 0;
        for (const OnlineModel *model : models_)
            if (const int n = model->NextUpdate(); n > 0) next = next > 0 ? std::min(next, n) : n;
        return next;
    }
    /// Updates those that are due, in order, and stops at the first that is cancelled.
    void Update(const Progress &progress) override {
        const int now = NextUpdate();
        if (now == 0) return;
        for (OnlineModel *model : models_) {
            if (model->NextUpdate() != now) continue;
            if (progress.Cancelled()) return;
            model->Update(progress);
            if (model->NextUpdate() == now) return;
        }
    }
    void ExtractRecords(StateWriter &out) override {
        for (OnlineModel *model : models_)
            if (model->NextUpdate() > 0) model->ExtractRecords(out);
    }
    void MergeRecords(StateReader &in) override {
        for (OnlineModel *model : models_)
            if (model->NextUpdate() > 0) model->MergeRecords(in);
    }

  private:
    std::vector<OnlineModel *> models_;
};

}  // namespace pbrt
