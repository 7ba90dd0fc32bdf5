#include "pbrt/core/online_model.h"

#include <algorithm>

#include "pbrt/core/progress.h"

namespace pbrt {

OnlineModels::OnlineModels(std::initializer_list<OnlineModel *> models) {
    for (OnlineModel *model : models)
        if (model) models_.push_back(model);
}

int OnlineModels::NextUpdate() const {
    int next = 0;
    for (const OnlineModel *model : models_)
        if (const int n = model->NextUpdate(); n > 0) next = next > 0 ? std::min(next, n) : n;
    return next;
}

void OnlineModels::Update(const Progress &progress) {
    const int now = NextUpdate();
    if (now == 0) return;
    for (OnlineModel *model : models_) {
        if (model->NextUpdate() != now) continue;
        if (progress.Cancelled()) return;
        model->Update(progress);
        if (model->NextUpdate() == now) return;
    }
}

void OnlineModels::ExtractRecords(StateWriter &out) {
    for (OnlineModel *model : models_)
        if (model->NextUpdate() > 0) model->ExtractRecords(out);
}

void OnlineModels::MergeRecords(StateReader &in) {
    for (OnlineModel *model : models_)
        if (model->NextUpdate() > 0) model->MergeRecords(in);
}

}  // namespace pbrt
