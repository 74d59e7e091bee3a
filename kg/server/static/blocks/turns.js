// Who comes first: what is kept, saved or shared is what was seen when that was asked for.

export class Turns {
  #taken = Promise.resolve();

  /** Do something with what is seen, which may have to be judged before. */
  take(act) {
    const done = act();
    this.#taken = Promise.allSettled([this.#taken, done]);
    return done;
  }

  /** Put something else in its place, once nothing is done with it any more. */
  async replace(act) {
    await this.#taken;
    act();
  }
}
