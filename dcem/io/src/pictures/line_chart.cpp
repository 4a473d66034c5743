#include "dcem/io/line_chart.hpp"

#include "dcem/io/src/pictures/chart_plan.hpp"

namespace dcem::io {
namespace {

void write_chart_sheet(const detail::ChartSheet& sheet, const std::string& title, AtomicFile& file,
                       PictureFormat format) {
  require_drawing(file);
  draw_picture(file.stream(), format, {sheet.width_px, sheet.height_px, title},
               [&](Canvas& canvas) { detail::draw_charts(canvas, sheet); });
}

}  // namespace

void write_line_charts(std::span<const LineChart> charts, AtomicFile& file, PictureFormat format) {
  const detail::ChartSheet sheet = detail::plan_line_charts(charts);
  write_chart_sheet(sheet, charts.front().title, file, format);
}

void write_line_charts(std::span<const LineChart> charts, const std::filesystem::path& path) {
  const PictureFormat format = picture_format_of(path);
  AtomicFile file(path);
  write_line_charts(charts, file, format);
  file.commit();
}

void write_panels(const std::string& title, std::span<const LineChart> charts, AtomicFile& file, PictureFormat format) {
  write_chart_sheet(detail::plan_panels(title, charts), title, file, format);
}

void write_panels(const std::string& title, std::span<const LineChart> charts, const std::filesystem::path& path) {
  const PictureFormat format = picture_format_of(path);
  AtomicFile file(path);
  write_panels(title, charts, file, format);
  file.commit();
}

}  // namespace dcem::io
