// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace hexaplast::runner {

/// Passes on what has been printed so far. Throws OutputError when it cannot be written, as on a full disk.
void flush_standard_output();

}  // namespace hexaplast::runner
