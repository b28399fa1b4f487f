/* Replaces libGLX in the wheel. OpenCV's core library refers to three of its functions, for displays by OpenGL, which
 * gladstone does not use; the real library requires X11, which a computer without a screen does not have. */
void* glXGetCurrentContext(void) { return 0; }
void* glXGetCurrentDisplay(void) { return 0; }
void* glXGetProcAddressARB(unsigned char const* name) {
  (void)name;
  return 0;
}
