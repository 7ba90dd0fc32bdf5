#pragma once
#include <initializer_list>
#include <vector>

namespace pbrt {

class Progress;
class StateReader;
class StateWriter;

/// Extension point: a model that is estimated from records of the render itself. It changes in Update only: between
/// waves, after fixed numbers of samples per pixel. Every sample depends on records of other samples, hence the
/// estimate is unbiased, and on no order of threads, hence the image is the same for any number of threads and any
/// split into waves.
class OnlineModel {
  public:
    virtual ~OnlineModel() = default;
    /// Samples per pixel after which Update must be called; 0: never again, and nothing needs to be recorded.
    virtual int NextUpdate() const = 0;
    /// May take seconds. If `progress` is cancelled meanwhile, returns soon and leaves the model as it was before.
    virtual void Update(const Progress &progress) = 0;
    /// Several processes may render the same pass, each some of its samples. Before Update, and before the model is
    /// saved, their records are merged: ExtractRecords writes the records and clears them, MergeRecords adds them. The
    /// result depends neither on the order nor on the division. MergeRecords throws UserError if the records belong to
    /// another model.
    virtual void ExtractRecords(StateWriter &out) = 0;
    virtual void MergeRecords(StateReader &in) = 0;
};

/// Several models as one. Refers to them; null ones are left out.
class OnlineModels final : public OnlineModel {
  public:
    OnlineModels(std::initializer_list<OnlineModel *> models);
    bool IsEmpty() const { return models_.empty(); }
    int NextUpdate() const override;
    /// Updates those that are due, in order; if one is cancelled, none after it.
    void Update(const Progress &progress) override;
    void ExtractRecords(StateWriter &out) override;
    void MergeRecords(StateReader &in) override;

  private:
    std::vector<OnlineModel *> models_;
};

}  // namespace pbrt
