#pragma once

namespace bodesmith {

class Progress;

/// Whether the display of this thread, if there is one, shows the work from here on; take_off_display() then ends it.
bool put_on_display(const Progress& work);
void take_off_display(const Progress& work);
/// From a signal handler too.
void erase_progress_line();

}  // namespace bodesmith
