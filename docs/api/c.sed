# Comments of claray.h in the form that Doxygen reads: of the file, of what follows, or of the member before.
1,/\*\//s|\*/|@file */|
s|^/\* ---- .* ---- \*/$||
s|^/\* |/** |
s|^\(.*[^ ].*\) /\* |\1 /**< |
