#include <nlohmann/json.hpp>

#include "exam/document.h"
#include "exam/state_folder.h"
#include "viewer/application.h"

namespace fathom {

namespace {

using Json = nlohmann::ordered_json;

Json number_or_null(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json points_json(const std::vector<Eigen::Vector2d>& points) {
  Json json = Json::array();
  for (const Eigen::Vector2d& point : points) json.push_back({point.x(), point.y()});
  return json;
}

Json structure_json(const Session& session, std::size_t index) {
  const Document& document = *session.document();
  const Structure& structure = document.structures()[index];
  Json json{{"name", structure.name}, {"color", structure.color}, {"opacity", structure.opacity}};
  json["contours"] = Json::array();
  for (const Contour& contour : structure.contours) {
    json["contours"].push_back({{"recording", contour.recording},
                                {"frame", contour.frame},
                                {"closed", contour.closed},
                                {"confidence", number_or_null(contour.confidence)},
                                {"points", points_json(contour.points_px)}});
  }
  json["absent"] = Json::array();
  for (const AbsentMark& mark : structure.absent) json["absent"].push_back(mark.frame);
  json["extremities"] = Json::array();
  for (const Extremity& extremity : structure.extremities) json["extremities"].push_back(extremity.frame);
  const StructureView* view = session.find_structure(document.content().ids[index]);
  if (view == nullptr) return json;
  json["sections"] = view->section_count;
  json["volume_ml"] = number_or_null(view->volumes.recommended_ml());
  json["volume_before_ml"] = number_or_null(view->volume_before_ml);
  json["surface_ml"] = number_or_null(view->surface.volume_ml);
  json["triangles"] = view->surface.mesh ? view->surface.mesh->triangles.size() : 0;
  json["surface_fault"] = view->surface.fault;
  json["surface_cancelled"] = view->surface.cancelled;
  json["warnings"] = view->warnings;
  json["confidence_fault"] = view->confidence.fault;
  if (view->confidence_is_current) add_confidence(view->confidence.confidence, json);
  return json;
}

Json document_json(const Session& session) {
  const Document& document = *session.document();
  Json json{{"title", document.title()},
            {"folder", document.exam().folder.string()},
            {"calibrated", document.is_calibrated()},
            {"modified", document.is_modified()},
            {"edits", document.history().edits().size()},
            {"edits_done", document.history().done()},
            {"history_bytes", document.history().bytes()},
            {"content_digest", std::to_string(content_digest(document.content()))},
            {"contours_text", contours_json(document.structures())}};
  json["texts"] = document.content().texts;
  json["planes"] = Json::array();
  for (const DividingPlane& plane : document.content().planes) {
    json["planes"].push_back(
        {{"normal", {plane.normal().x(), plane.normal().y(), plane.normal().z()}}, {"offset_mm", -plane.offset()}});
  }
  json["structures"] = Json::array();
  for (std::size_t i = 0; i < document.structures().size(); ++i)
    json["structures"].push_back(structure_json(session, i));
  return json;
}

Json view_json(const Session& session) {
  const ViewState& view = session.view;
  Json json{{"recording", view.recording},
            {"frame", view.frame},
            {"frames", session.frame_count()},
            {"structure", view.structure},
            {"tool", static_cast<int>(view.tool)},
            {"brush_px", view.brush_px},
            {"level", view.level},
            {"window", view.window},
            {"zoom", view.zoom},
            {"line", points_json(view.line_px)},
            {"ruler", points_json(view.ruler_px)},
            {"seeds", points_json(view.seeds_px)},
            {"ruler_text", ruler_text(session)}};
  json["preview"] = Json::array();
  for (const Polygon& outline : view.preview_px) json["preview"].push_back(points_json(outline));
  return json;
}

Json live_json(const LiveView& live) {
  Json json{{"connected", live.connected()},
            {"recording", live.recording()},
            {"shown", live.shown()},
            {"folder", live.folder().string()},
            {"delay_p95_s", number_or_null(live.delay_p95_s())}};
  if (live.connected()) {
    const SessionStatistics now = live.statistics();
    json["received"] = now.images.received;
    json["rate_hz"] = now.images.rate_hz;
    json["tracked"] = now.tracked;
    json["transforms"] = now.transforms.size();
    json["geometry_fault"] = now.geometry_fault;
  }
  if (live.recording()) {
    json["frames"] = live.status().frames;
    json["state"] = static_cast<int>(live.status().state);
  }
  if (live.verdict()) json["verdict"] = {{"frames", live.verdict()->frames}, {"warnings", live.verdict()->warnings}};
  return json;
}

}  // namespace

std::string state_json(const Session& session, const ResliceViews& reslices, const LiveView& live,
                       const Settings& settings) {
  Json json;
  json["document"] = session.document() != nullptr ? document_json(session) : Json(nullptr);
  json["view"] = view_json(session);
  json["reslices"] = Json::array();
  for (std::size_t i = 0; i < ResliceViews::kCount; ++i) {
    const ResliceViews::View& view = reslices.view(i);
    const Eigen::Vector3d centre = view.plane.centre_mm;
    const Eigen::Vector3d normal = view.plane.normal();
    json["reslices"].push_back({{"centre_mm", {centre.x(), centre.y(), centre.z()}},
                                {"normal", {normal.x(), normal.y(), normal.z()}},
                                {"picture", view.number},
                                {"error", view.error}});
  }
  json["live"] = live_json(live);
  json["messages"] = Json::array();
  for (const Message& message : session.messages()) {
    json["messages"].push_back({{"about", message.about}, {"text", message.text}, {"is_error", message.is_error}});
  }
  json["jobs"] = Json::array();
  for (const JobStatus& job : session.worker().jobs()) json["jobs"].push_back(job.key);
  json["settings"] = {{"dark", settings.dark},     {"scale", settings.scale}, {"left", settings.left},
                      {"middle", settings.middle}, {"upper", settings.upper}, {"main", settings.main}};
  json["recent"] = Json::array();
  for (const std::filesystem::path& path : recent_files()) json["recent"].push_back(path.string());
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace fathom
