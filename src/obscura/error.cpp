#include <fmt/format.h>

#include <new>

#include "app/console/exit.h"
#include "app/console/interrupt.h"
#include "app/run/trouble.h"
#include "draw/picture/error.h"
#include "gl/error.h"
#include "media/error.h"
#include "obscura/inside.h"
#include "page/error.h"
#include "scene/error.h"

namespace obscura {

namespace {

std::string text_of(const std::vector<Fault>& all) {
  std::string text;
  for (const Fault& each : all) text += (text.empty() ? "" : "\n") + each.text();
  return text;
}

}  // namespace

std::string_view version() noexcept { return OBSCURA_VERSION; }

std::string Fault::text() const {
  if (!key.empty()) return fmt::format("{}: {}: {}", file, key, message);
  if (line == 0) return fmt::format("{}: {}", file, message);
  return fmt::format("{}:{}:{}: {}", file, line, column, message);
}

SceneError::SceneError(std::vector<Fault> all) : Error(text_of(all)), faults(std::move(all)) {}

void interrupt_by(std::function<bool()> stop) { app::interrupt_by(std::move(stop)); }

RunError run_error(const std::string& scene, const sim::Trouble& trouble) {
  RunError error(scene + ": " + app::text(trouble));
  error.time = trouble.time;
  error.body = trouble.body, error.quantity = trouble.quantity;
  error.fault = trouble.what, error.likely = trouble.likely;
  return error;
}

void rethrow() {
  try {
    throw;
  } catch (const scene::Error& error) {
    std::vector<Fault> faults;
    for (const scene::Complaint& each : error.complaints)
      faults.push_back({each.file, each.line, each.column, "", each.message});
    throw SceneError(std::move(faults));
  } catch (const app::TroubleError& error) {
    const std::string text = error.what();
    throw run_error(text.substr(0, text.find(": at t = ")), error.trouble);
  } catch (const app::UsageError& error) {
    throw UsageError(error.what());
  } catch (const app::Interrupted&) {
    throw Interrupted("interrupted");
  } catch (const media::Error& error) {
    throw FileError(error.what());
  } catch (const gl::Error& error) {
    throw FileError(error.what());
  } catch (const page::Error& error) {
    throw FileError(error.what());
  } catch (const draw::Error& error) {
    throw FileError(error.what());
  }
}

}  // namespace obscura
