#pragma once
#include <memory>

#include "ext/lightgroups/emitter.h"
#include "ext/lightgroups/light_tree.h"
#include "ext/lightgroups/mesh_interior.h"
#include "ext/octree/visibility_model.h"
#include "ext/portals/portal_sampling.h"

namespace ext {

/// Group light samplers with a learned VisibilityModel: prepass, trial of portals, saved state and reports. Derived
/// classes select groups. They only read the protected members, which change in Prepare and in updates of the model.
class LearnedVisibilityLightSampler : public InteriorLightSampler {
  public:
    LearnedVisibilityLightSampler(const LightTable &lights, const OctreeParams &params);

    void Prepare(PrepareContext &context) override;
    OnlineModel *Model() override { return model_.IsUpdated() ? &model_ : nullptr; }
    PathObserver *Observer() override { return model_.IsUpdated() ? &model_ : nullptr; }
    bool ChoosesRegions() const override { return portals_.IsActive(); }
    bool LearnsRoulette() const override { return true; }
    bool SavesLearned() const override { return true; }
    void SaveLearned(StateWriter &writer, bool withLearning) const override;
    void Report(nlohmann::ordered_json &report) const override;
    void Inspect(const LightQuery &query, std::vector<InspectedValue> &values) const override;
    std::string DescribeStructure() const override;

  protected:
    const OctreeParams params_;
    const Float floor_;
    PortalSampling portals_;
    GroupImportance importance_;            ///< zero for environment lights with portals
    std::unique_ptr<LightTree> lightTree_;  ///< null: at most kMaxCandidates groups, all evaluated
    VisibilityModel model_;

  private:
    void PortalsChanged();
    void Learn(PrepareContext &context, std::span<PrepassVertex> vertices);
    /// Keeps the portals if a trial shows that they reduce the error at equal cost.
    void TryPortals(PrepareContext &context, std::span<PrepassVertex> vertices);
    void LoadLearned(const PrepareContext &context, StateReader &reader);
    uint64_t LightTreeHash() const;  ///< hash of the lights and light tree nodes that a saved model refers to

    double prepassSeconds_ = 0;
};

}  // namespace ext
