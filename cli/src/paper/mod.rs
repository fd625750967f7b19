pub mod convergence;
pub mod example;
pub fn run(o: &crate::arguments::PaperOptions) -> Result<(), crate::failure::Failure> {
    for s in ["zero", "consistent"] {
        for r in convergence::errors(s, if o.quick { 64 } else { 256 })? {
            crate::console::say(&format!("{s} {r:?}"))?;
        }
    }
    Ok(())
}
