// Order of actions: the text saved or shared is that seen at the time of the request.

export class Turns {
  #taken = Promise.resolve();

  /** Do something with the current text, which may have to be checked before. */
  take(act) {
    const done = act();
    this.#taken = Promise.allSettled([this.#taken, done]);
    return done;
  }

  /** Replace it, once all actions on it are done. */
  async replace(act) {
    await this.#taken;
    act();
  }
}
